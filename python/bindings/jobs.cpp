#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <numbers>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/pipeline/measure.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/pipeline/simplify.hpp"

namespace shapelight::python {
namespace {

// Choosing how curvature is estimated ends the adaptive choice, as on the command line.
bool chooses_curvature(const nb::dict& given) {
  return given.contains("curvature_method") || given.contains("curvature_passes");
}

nb::dict sample_job(const InputView& input, std::optional<std::uint64_t> count, std::optional<double> ratio,
                    std::optional<double> spacing, const std::string& preset, const nb::dict& given, nb::object threads,
                    nb::object progress) {
  SampleOptions options = sample_preset(enum_named<Preset>("preset", preset));
  apply_options(options, given);
  if (chooses_curvature(given)) options.fields.adaptive = false;
  SampleResult result = run({threads, progress}, [&](const RunContext& context) {
    return sample(input.view, {.count = count, .ratio = ratio, .spacing = spacing}, options, context);
  });
  nb::dict d;
  d["indices"] = to_numpy(std::move(result.indices));
  d["usable"] = result.usable;
  d["candidates"] = result.candidates;
  d["last_resort"] = result.last_resort;
  d["noise"] = result.noise;
  d["denoised"] = result.denoised;
  d["diagnostics"] = to_dict(result.diagnostics);
  return d;
}

nb::dict fields_job(const InputView& input, const std::string& preset, const nb::dict& given, nb::object threads,
                    nb::object progress) {
  FieldsOptions options = fields_preset(enum_named<Preset>("preset", preset));
  apply_options(options, given);
  if (chooses_curvature(given)) options.adaptive = false;
  PointFields result =
      run({threads, progress}, [&](const RunContext& context) { return point_fields(input.view, options, context); });
  nb::dict d;
  d["attributes"] = to_dict(std::move(result.attributes));
  d["noise"] = result.noise;
  d["mean_edge_length"] = result.mean_edge_length;
  d["denoised"] = result.denoised;
  d["curvature_method"] = std::string(enum_name(result.curvature_method));
  d["num_segments"] = result.num_segments;
  d["diagnostics"] = to_dict(result.diagnostics);
  return d;
}

// The preset, for the placement that was asked for, with single options on top. The paper's method without a preset
// means the paper's preset.
SimplifyOptions simplify_options(const std::optional<std::string>& preset_name, const nb::dict& given) {
  const auto asked = make_options<SimplifyOptions>(given);
  const bool is_paper = !preset_name && asked.method == SimplifyMethod::SsimPaper;
  const SimplifyPreset preset = is_paper       ? SimplifyPreset::Paper
                                : !preset_name ? SimplifyPreset::Detail
                                               : enum_named<SimplifyPreset>("preset", *preset_name);
  SimplifyOptions options = simplify_preset(preset, asked.ssim.placement);
  apply_options(options, given);
  if (chooses_curvature(given)) options.fields.adaptive = false;
  return options;
}

nb::dict simplify_job(const InputView& input, std::optional<std::uint64_t> vertices, std::optional<std::uint64_t> faces,
                      std::optional<double> ratio, std::optional<double> max_error,
                      const std::optional<std::string>& preset, const nb::dict& given, nb::object threads,
                      nb::object progress) {
  const SimplifyOptions options = simplify_options(preset, given);
  const SimplifySize size{.vertices = vertices, .faces = faces, .ratio = ratio, .max_error = max_error};
  SimplifyResult result =
      run({threads, progress}, [&](const RunContext& context) { return simplify(input.view, size, options, context); });
  nb::dict d;
  d["geometry"] = to_dict(std::move(result.geometry));
  d["source_vertex"] = to_numpy(std::move(result.source_vertex));
  d["sampled"] = result.sampled;
  d["vertices_in"] = result.vertices_in;
  d["faces_in"] = result.faces_in;
  d["noise"] = result.noise;
  d["denoised"] = result.denoised;
  d["oddities"] = to_dict(result.oddities);
  d["measured"] = result.measured ? nb::object(to_dict(*result.measured)) : nb::none();
  d["warnings"] = result.warnings;
  return d;
}

nb::dict metrics_job(const InputView& reference, const InputView& test, bool wants_distances, const nb::dict& given,
                     nb::object threads, nb::object progress) {
  const auto options = make_options<SurfaceDistanceOptions>(given);
  std::vector<double> distances;
  const MeasureResult result = run({threads, progress}, [&](const RunContext& context) {
    if (wants_distances) {
      distances = distances_to_surface(reference.view, test.view, context.phase(0.0, 0.3, "distances"));
    }
    return measure(reference.view, test.view, options, context.phase(wants_distances ? 0.3 : 0.0, 1.0, "measure"));
  });
  nb::dict d;
  d["surfaces"] = result.surfaces ? nb::object(to_dict(*result.surfaces)) : nb::none();
  d["points"] = result.points ? nb::object(to_dict(*result.points)) : nb::none();
  d["distances"] = wants_distances ? to_numpy(std::move(distances)) : nb::none();
  d["warnings"] = result.warnings;
  return d;
}

}  // namespace

nb::dict to_dict(const SurfaceDistance& distance) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const auto summary = [](const DistanceSummary& s) {
    nb::dict d;
    d["mean"] = s.mean;
    d["rms"] = s.rms;
    d["max"] = s.max;
    return d;
  };
  nb::dict d;
  d["forward"] = summary(distance.forward);
  d["backward"] = summary(distance.backward);
  d["symmetric"] = summary(distance.symmetric);
  d["vertex_rms"] = distance.vertex_rms;
  d["diagonal"] = distance.diagonal;
  nb::dict deviation;
  deviation["rms"] = distance.normal_deviation.rms * kDegrees;
  deviation["p95"] = distance.normal_deviation.p95 * kDegrees;
  d["normal_deviation_deg"] = deviation;
  d["samples"] = distance.samples;
  return d;
}

nb::dict to_dict(const SamplingQuality& q) {
  nb::dict d;
  d["coverage_max"] = q.coverage_max;
  d["coverage_mean"] = q.coverage_mean;
  d["feature_coverage_max"] = q.feature_coverage_max;
  d["feature_coverage_mean"] = q.feature_coverage_mean;
  d["feature_share"] = q.feature_share;
  d["spacing_mean"] = q.spacing_mean;
  d["spacing_min"] = q.spacing_min;
  d["spacing_cv"] = q.spacing_cv;
  return d;
}

void bind_jobs(nb::module_& module) {
  publish_options<SampleOptions>(module, "sample");
  module.def("sample", &sample_job, nb::arg("input"), nb::arg("count").none(), nb::arg("ratio").none(),
             nb::arg("spacing").none(), nb::arg("preset"), nb::arg("options"), nb::arg("threads").none(),
             nb::arg("progress").none());
  publish_options<FieldsOptions>(module, "fields");
  module.def("fields", &fields_job, nb::arg("input"), nb::arg("preset"), nb::arg("options"), nb::arg("threads").none(),
             nb::arg("progress").none());
  publish_options<SimplifyOptions>(module, "simplify");
  module.def("simplify", &simplify_job, nb::arg("input"), nb::arg("vertices").none(), nb::arg("faces").none(),
             nb::arg("ratio").none(), nb::arg("max_error").none(), nb::arg("preset").none(), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
  publish_options<SurfaceDistanceOptions>(module, "metrics");
  module.def("metrics", &metrics_job, nb::arg("reference"), nb::arg("test"), nb::arg("distances"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
}

}  // namespace shapelight::python
