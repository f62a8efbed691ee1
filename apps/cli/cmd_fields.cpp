#include <fmt/format.h>

#include "commands.hpp"
#include "described_options.hpp"
#include "run.hpp"
#include "shapelight/pipeline/fields.hpp"
#include "shapelight/pipeline/memory_estimate.hpp"

namespace shapelight::cli {
namespace {

struct FieldsArguments {
  std::string input, output, preset = "detail";
  CommonOptions common;
};

int run_fields(const FieldsArguments& arguments, const DescribedFlags<FieldsOptions>& flags, std::stop_token stop) {
  Run run("fields", arguments.common, std::move(stop));
  FieldsOptions options = fields_preset(parse_enum<Preset>("preset", arguments.preset));
  flags.apply(options);
  if (flags.was_given("curvature-method") || flags.was_given("curvature-passes")) options.adaptive = false;
  validate_options(options);
  run.check_output(arguments.output);

  Geometry geometry = run.read(arguments.input);
  run.check_output(arguments.output);
  run.check_memory(geometry.size() * kFieldsBytesPerPoint);
  PointFields result = run.timed("fields", [&] { return point_fields(geometry, options, run.context()); });
  run.warn(result.diagnostics);
  geometry.attributes.set(std::move(result.attributes));
  run.write(arguments.output, geometry);
  run.points_in = run.points_out = geometry.size();
  run.options = options_json(options);
  run.options["preset"] = arguments.preset;
  const double h = result.mean_edge_length;
  run.result = {{"noise", result.noise},
                {"mean_edge_length", h},
                {"denoised", result.denoised},
                {"curvature_method", enum_name(result.curvature_method)},
                {"segments", result.num_segments},
                {"outliers", result.diagnostics.outliers},
                {"boundary", result.diagnostics.boundary_vertices},
                {"components", result.diagnostics.components}};
  run.say(fmt::format("{}: fields of {} points, {} segments, noise {:.3g} ({:.2g} of the mean edge)", arguments.output,
                      geometry.size(), result.num_segments, result.noise, h > 0.0 ? result.noise / h : 0.0));
  run.finish();
  return 0;
}

}  // namespace

Command add_fields_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("fields", "Write the input with its shape fields, one value per point.");
  auto arguments = std::make_shared<FieldsArguments>();
  command->add_option("input", arguments->input, "Mesh, range image or point cloud.")->required()->type_name("IN");
  command
      ->add_option("-o,--output", arguments->output,
                   "The input with shape_index, curvedness, illumination, reflectance, segment, importance.")
      ->required()
      ->type_name("OUT");
  command
      ->add_option("--preset", arguments->preset,
                   "detail, fast (no NLM, no Retinex) or paper (the literal paper). (detail)")
      ->type_name("detail|fast|paper");
  auto flags = std::make_shared<DescribedFlags<FieldsOptions>>(*command, std::initializer_list<std::string_view>{});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_fields(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
