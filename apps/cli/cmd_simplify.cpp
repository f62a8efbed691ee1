#include <fmt/format.h>

#include <numbers>

#include "attribute_choice.hpp"
#include "commands.hpp"
#include "described_options.hpp"
#include "run.hpp"
#include "shapelight/pipeline/memory_estimate.hpp"
#include "shapelight/pipeline/simplify.hpp"

namespace shapelight::cli {
namespace {

constexpr int kTargetUnreachable = 5;

struct SimplifyArguments {
  std::string input, output, vertices, faces, ratio, max_error, preset;
  AttributeChoice attributes;
  bool index_field = false;
  bool allow_partial = false;
  CommonOptions common;
};

SimplifySize size_of(const SimplifyArguments& arguments, double diagonal) {
  SimplifySize size;
  if (!arguments.vertices.empty()) size.vertices = parse_count("vertices", arguments.vertices);
  if (!arguments.faces.empty()) size.faces = parse_count("faces", arguments.faces);
  if (!arguments.ratio.empty()) size.ratio = parse_ratio("ratio", arguments.ratio);
  if (!arguments.max_error.empty()) size.max_error = parse_length("max-error", arguments.max_error).resolve(diagonal);
  validate(size);
  return size;
}

// The preset, for the placement that was asked for, with single options on top. The paper's method without a preset
// means the paper's preset.
SimplifyOptions resolve_options(const std::string& preset_name, const DescribedFlags<SimplifyOptions>& flags) {
  SimplifyOptions typed;
  flags.apply(typed);
  const bool is_paper = preset_name.empty() && typed.method == SimplifyMethod::SsimPaper;
  const SimplifyPreset preset = is_paper              ? SimplifyPreset::Paper
                                : preset_name.empty() ? SimplifyPreset::Detail
                                                      : parse_enum<SimplifyPreset>("preset", preset_name);
  SimplifyOptions options = simplify_preset(preset, typed.ssim.placement);
  flags.apply(options);
  if (flags.was_given("curvature-method") || flags.was_given("curvature-passes")) options.fields.adaptive = false;
  validate_options(options);
  return options;
}

struct Outcome {
  SimplifyResult simplified;
  bool is_partial = false;
};
// As far as it goes, when the target cannot be reached and that is allowed.
Outcome simplify_within_reach(const Geometry& geometry, const SimplifySize& size, const SimplifyOptions& options,
                              bool allow_partial, Run& run) {
  try {
    return {simplify(geometry, size, options, run.context()), false};
  } catch (const TargetUnreachable& error) {
    if (!allow_partial || error.reachable() == 0) throw;
    run.warn(error.what());
    SimplifySize reachable;
    (size.faces ? reachable.faces : reachable.vertices) = error.reachable();
    return {simplify(geometry, reachable, options, run.context()), true};
  }
}

nlohmann::ordered_json result_json(const SimplifyResult& result, const SimplifyOptions& options,
                                   const SimplifySize& size) {
  nlohmann::ordered_json json = {{"vertices_in", result.vertices_in},
                                 {"surface_vertices", result.surface_vertices},
                                 {"faces_in", result.faces_in},
                                 {"vertices", result.geometry.size()},
                                 {"faces", result.geometry.triangles.size()},
                                 {"kind", geometry_kind_name(result.geometry.kind())},
                                 {"sampled", result.sampled},
                                 {"method", enum_name(options.method)},
                                 {"placement", enum_name(options.ssim.placement)},
                                 {"noise", result.noise},
                                 {"denoised", result.denoised}};
  if (result.measured) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    const SurfaceDistance& distance = *result.measured;
    const DistanceSummary relative = distance.symmetric.scaled(1.0 / distance.diagonal);
    json["measured_rms_error"] = distance.symmetric.rms;
    json["measured_max_error"] = distance.symmetric.max;
    json["relative"] = {{"measured_rms_error", relative.rms}, {"measured_max_error", relative.max}};
    json["normal_deviation_deg"] = {{"rms", distance.normal_deviation.rms * kDegrees},
                                    {"p95", distance.normal_deviation.p95 * kDegrees}};
  }
  if (size.max_error) json["runs"] = result.runs;
  return json;
}

void say_result(const Run& run, const std::string& output, const SimplifyResult& result,
                const SimplifyOptions& options) {
  const double share = 100.0 * static_cast<double>(result.geometry.size()) / static_cast<double>(result.vertices_in);
  if (result.sampled) {
    run.say(
        fmt::format("{}: {} of {} points kept ({:.3g} %)", output, result.geometry.size(), result.vertices_in, share));
  } else {
    run.say(fmt::format("{}: {} of {} vertices ({:.3g} %), {} of {} faces, method {}, placement {}", output,
                        result.geometry.size(), result.vertices_in, share, result.geometry.triangles.size(),
                        result.faces_in, enum_name(options.method), enum_name(options.ssim.placement)));
  }
  if (!result.measured) return;
  const DistanceSummary& distance = result.measured->symmetric;
  const DistanceSummary percent = distance.scaled(100.0 / result.measured->diagonal);
  run.say(fmt::format("measured both ways: rms {:.4g} ({:.3g} % of the diagonal), max {:.4g} ({:.3g} %)", distance.rms,
                      percent.rms, distance.max, percent.max));
}

int run_simplify(const SimplifyArguments& arguments, const DescribedFlags<SimplifyOptions>& flags,
                 std::stop_token stop) {
  Run run("simplify", arguments.common, std::move(stop));
  (void)size_of(arguments, 1.0);  // bad usage is told before anything is read
  const SimplifyOptions options = resolve_options(arguments.preset, flags);
  run.check_output(arguments.output);

  Geometry geometry = run.read(arguments.input);
  run.check_output(arguments.output);
  run.check_memory(geometry.size() * kSimplifyBytesPerPoint);
  run.attributes_dropped = arguments.attributes.apply(geometry.attributes);
  const SimplifySize size = size_of(arguments, bounding_box(geometry.positions).diagonal());
  auto [result, is_partial] = run.timed(
      "simplify", [&] { return simplify_within_reach(geometry, size, options, arguments.allow_partial, run); });

  for (const std::string& warning : result.warnings) run.warn(warning);
  if (arguments.index_field) result.geometry.attributes.set({"source_index", result.source_vertex});
  run.write(arguments.output, result.geometry);
  run.points_in = geometry.size();
  run.points_out = result.geometry.size();
  run.options = options_json(options);
  run.options["preset"] = enum_name(options.preset);
  if (size.vertices) run.options["vertices"] = *size.vertices;
  if (size.faces) run.options["faces"] = *size.faces;
  if (size.ratio) run.options["ratio"] = *size.ratio;
  if (size.max_error) run.options["max-error"] = *size.max_error;
  run.result = result_json(result, options, size);
  say_result(run, arguments.output, result, options);
  run.finish();
  return is_partial ? kTargetUnreachable : 0;
}

}  // namespace

Command add_simplify_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("simplify", "Fewer vertices, the same shape, exactly as many as asked for.");
  auto arguments = std::make_shared<SimplifyArguments>();
  command->add_option("input", arguments->input, "Mesh or range image; of a point cloud the points are sampled.")
      ->required()
      ->type_name("IN");
  command->add_option("-o,--output", arguments->output, "The simplified mesh.")->required()->type_name("OUT");
  command->add_option("--vertices", arguments->vertices, "Vertices to keep: 1200, 50k, 2M.")->type_name("N");
  command->add_option("--faces", arguments->faces, "Faces to keep, within one.")->type_name("N");
  command->add_option("--ratio", arguments->ratio, "Share of the vertices to keep: 0.1 or 10%.")->type_name("R");
  command
      ->add_option("--max-error", arguments->max_error,
                   "Largest distance to the input, both ways, in the file's units or % of the diagonal.")
      ->type_name("E");
  command
      ->add_option("--preset", arguments->preset,
                   "detail, fast (fewer sweeps), best (more) or paper (the literal paper). (detail)")
      ->type_name("detail|fast|best|paper");
  command->add_flag("--index-field", arguments->index_field, "Write source_index: the input index of each vertex.");
  command->add_flag("--allow-partial", arguments->allow_partial,
                    "Write what can be had when the target cannot be reached (exit code 5).");
  arguments->attributes.add_options(*command);
  auto flags = std::make_shared<DescribedFlags<SimplifyOptions>>(
      *command, std::initializer_list<std::string_view>{"method", "placement", "sample-weight", "boundary-weight",
                                                        "normal-weight", "pre-collapse", "sweeps", "local-weight",
                                                        "noise-threshold", "measure"});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_simplify(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
