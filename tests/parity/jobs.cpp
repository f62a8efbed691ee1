#include "recorder.hpp"
#include "shapelight/pipeline/align.hpp"
#include "shapelight/pipeline/fields.hpp"
#include "shapelight/pipeline/measure.hpp"
#include "shapelight/pipeline/register.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/pipeline/simplify.hpp"

namespace shapelight::parity {
namespace {

void record_summary(const Recorder& recorder, const std::string& name, const DistanceSummary& d) {
  recorder.record(name, std::vector<double>{d.mean, d.rms, d.max});
}

void record_distance(const Recorder& recorder, const std::string& name, const SurfaceDistance& d) {
  record_summary(recorder, name + ".forward", d.forward);
  record_summary(recorder, name + ".backward", d.backward);
  record_summary(recorder, name + ".symmetric", d.symmetric);
}

}  // namespace

void record_jobs(const Recorder& recorder) {
  const Geometry dragon = data("scans/dragonStandRight_0.ply"), turned = data("scans/dragonStandRight_24.ply");
  const Geometry fandisk = data("meshes/fandisk.off");
  recorder.record("sample", sample(dragon, {.count = {}, .ratio = 0.05, .spacing = {}}).indices);
  recorder.record("sample.paper",
                  sample(fandisk, {.count = 500, .ratio = {}, .spacing = {}}, sample_preset(Preset::Paper)).indices);

  const PointFields fields = point_fields(fandisk, fields_preset(Preset::Detail));
  for (const Column& column : fields.attributes.columns()) {
    std::visit([&](const auto& values) { recorder.record("fields." + column.name, values); }, column.values);
  }

  SimplifyOptions options = simplify_preset(SimplifyPreset::Fast, Placement::Optimal);
  options.measure = true;
  const SimplifyResult simplified =
      simplify(fandisk, {.vertices = {}, .faces = {}, .ratio = 0.2, .max_error = {}}, options);
  recorder.record("simplify.vertices", simplified.geometry.positions);
  recorder.record("simplify.faces", simplified.geometry.triangles);
  recorder.record("simplify.source_vertex", simplified.source_vertex);
  record_distance(recorder, "simplify.measured", *simplified.measured);

  record_distance(recorder, "metrics", *measure(fandisk, simplified.geometry, {.samples = 20000, .seed = 3}).surfaces);
  recorder.record("metrics.distances", distances_to_surface(fandisk, simplified.geometry));
  const SamplingQuality quality = *measure(fandisk, data("clouds/simple.las")).points;
  recorder.record("metrics.coverage", std::vector<double>{quality.coverage_max, quality.feature_coverage_mean});

  const RegisterResult registered = register_scans(turned, dragon);
  recorder.record("register", registered.T_target_source);
  recorder.record("register.confidence", registered.assessment.confidence);

  const std::vector<Geometry> scans = {dragon, turned};
  const AlignResult aligned = align_scans(views_of(scans));
  recorder.record("align", aligned.scans[1].T_world_scan);
  recorder.record("align.merged", merge_scans(scans, aligned).positions);
}

}  // namespace shapelight::parity
