#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <optional>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/metrics/surface_distance.hpp"

namespace shapelight::python {
namespace {

nb::dict sampling(const PointsArray& reference, const PointsArray& samples,
                  const std::optional<VectorArray<double>>& importance, int threads, nb::object progress) {
  const SamplingQuality q = run({threads, progress}, [&](const RunContext& context) {
    return measure_sampling(as_span(reference), importance ? as_span(*importance) : std::span<const double>{},
                            as_span(samples), context);
  });
  nb::dict d;
  d["coverage_max"] = q.coverage_max;
  d["coverage_mean"] = q.coverage_mean;
  d["feature_coverage_mean"] = q.feature_coverage_mean;
  d["feature_coverage_max"] = q.feature_coverage_max;
  d["feature_share"] = q.feature_share;
  d["spacing_mean"] = q.spacing_mean;
  d["spacing_min"] = q.spacing_min;
  d["spacing_cv"] = q.spacing_cv;
  return d;
}

nb::object variation(const PointsArray& points, std::size_t k, int threads, nb::object progress) {
  return to_numpy(run({threads, progress},
                      [&](const RunContext& context) { return surface_variation_knn(as_span(points), k, context); }));
}

nb::dict to_dict(const DistanceSummary& summary) {
  nb::dict d;
  d["mean"] = summary.mean;
  d["rms"] = summary.rms;
  d["max"] = summary.max;
  return d;
}

nb::dict surface_distance(const InputView& reference, const InputView& test, const nb::dict& given, int threads,
                          nb::object progress) {
  const auto options = make_options<SurfaceDistanceOptions>(given);
  const SurfaceDistance found = run({threads, progress}, [&](const RunContext& context) {
    return measure_surface_distance(reference.mesh(), test.mesh(), options, context);
  });
  nb::dict deviation;
  deviation["rms"] = found.normal_deviation.rms;
  deviation["p95"] = found.normal_deviation.p95;
  nb::dict d;
  d["forward"] = to_dict(found.forward);
  d["backward"] = to_dict(found.backward);
  d["symmetric"] = to_dict(found.symmetric);
  d["vertex_rms"] = found.vertex_rms;
  d["diagonal"] = found.diagonal;
  d["normal_deviation"] = deviation;
  d["samples"] = found.samples;
  return d;
}

nb::object distances(const InputView& mesh, const TriangleTree& surface, int threads, nb::object progress) {
  return to_numpy(run({threads, progress},
                      [&](const RunContext& context) { return vertex_distances(mesh.mesh(), surface, context); }));
}

}  // namespace

void bind_metrics(nb::module_& module) {
  module.def("measure_sampling", &sampling, nb::arg("reference").noconvert(), nb::arg("samples").noconvert(),
             nb::arg("importance").noconvert().none(), nb::arg("threads"), nb::arg("progress").none());
  module.def("surface_variation_knn", &variation, nb::arg("points").noconvert(), nb::arg("k"), nb::arg("threads"),
             nb::arg("progress").none());
  publish_options<SurfaceDistanceOptions>(module, "measure_surface_distance");
  module.def("measure_surface_distance", &surface_distance, nb::arg("reference"), nb::arg("test"), nb::arg("options"),
             nb::arg("threads"), nb::arg("progress").none());
  module.def("vertex_distances", &distances, nb::arg("mesh"), nb::arg("surface"), nb::arg("threads"),
             nb::arg("progress").none());
}

}  // namespace shapelight::python
