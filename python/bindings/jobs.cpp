#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/pipeline/sample.hpp"

namespace shapelight::python {
namespace {

template <class E>
E enum_named(const char* option, const std::string& text) {
  E value{};
  set_option(OptionInfo{option, "", ""}, nb::cast(text), value);
  return value;
}

// Choosing how curvature is estimated ends the adaptive choice, as on the command line.
bool chooses_curvature(const nb::dict& given) {
  return given.contains("curvature_method") || given.contains("curvature_passes");
}

nb::dict sample_job(const InputView& input, std::optional<std::uint64_t> count, std::optional<double> ratio,
                    std::optional<double> spacing, const std::string& preset, const nb::dict& given, int threads,
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

nb::dict fields_job(const InputView& input, const std::string& preset, const nb::dict& given, int threads,
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

}  // namespace

void bind_jobs(nb::module_& module) {
  publish_options<SampleOptions>(module, "sample");
  module.def("sample", &sample_job, nb::arg("input"), nb::arg("count").none(), nb::arg("ratio").none(),
             nb::arg("spacing").none(), nb::arg("preset"), nb::arg("options"), nb::arg("threads"),
             nb::arg("progress").none());
  publish_options<FieldsOptions>(module, "fields");
  module.def("fields", &fields_job, nb::arg("input"), nb::arg("preset"), nb::arg("options"), nb::arg("threads"),
             nb::arg("progress").none());
}

}  // namespace shapelight::python
