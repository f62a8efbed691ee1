#include <numbers>

#include "recorder.hpp"
#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/metrics/surface_distance.hpp"

namespace shapelight::parity {
namespace {

void record_summary(const Recorder& recorder, const std::string& name, const DistanceSummary& s) {
  recorder.record("measure_surface_distance." + name, std::vector<double>{s.mean, s.rms, s.max});
}

}  // namespace

void record_metrics(const Recorder& recorder) {
  const Geometry mesh = data("meshes/fandisk.off");
  std::vector<double> importance;
  std::vector<Vec3> samples, moved;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    importance.push_back(static_cast<double>(i % 11));
    if (i % 9 == 0) samples.push_back(mesh.positions[i]);
    moved.push_back(1.25 * mesh.positions[i]);
  }
  const SamplingQuality q = measure_sampling(mesh.positions, importance, samples);
  recorder.record("measure_sampling.coverage", std::vector<double>{q.coverage_max, q.coverage_mean});
  recorder.record("measure_sampling.feature",
                  std::vector<double>{q.feature_coverage_max, q.feature_coverage_mean, q.feature_share});
  recorder.record("measure_sampling.spacing", std::vector<double>{q.spacing_mean, q.spacing_min, q.spacing_cv});
  recorder.record("surface_variation_knn", surface_variation_knn(mesh.positions, 12));

  const TriangleMesh reference{mesh.positions, mesh.triangles};
  const TriangleMesh test{moved, mesh.triangles};
  const SurfaceDistance d = measure_surface_distance(reference, test, {.samples = 5000, .seed = 3});
  record_summary(recorder, "forward", d.forward);
  record_summary(recorder, "backward", d.backward);
  record_summary(recorder, "symmetric", d.symmetric);
  recorder.record("measure_surface_distance.vertex_rms", d.vertex_rms);
  recorder.record("measure_surface_distance.diagonal", d.diagonal);
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  recorder.record("measure_surface_distance.normal_deviation_deg",
                  std::vector<double>{d.normal_deviation.rms * kDegrees, d.normal_deviation.p95 * kDegrees});
  recorder.record("measure_surface_distance.samples", d.samples);
  recorder.record("vertex_distances", vertex_distances(reference, TriangleTree(test)));
}

}  // namespace shapelight::parity
