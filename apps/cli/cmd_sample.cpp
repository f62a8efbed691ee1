#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "attribute_choice.hpp"
#include "commands.hpp"
#include "described_options.hpp"
#include "run.hpp"
#include "shapelight/pipeline/memory_estimate.hpp"
#include "shapelight/pipeline/sample.hpp"

namespace shapelight::cli {
namespace {

constexpr int kTargetUnreachable = 5;

struct SampleArguments {
  std::string input, output, count, ratio, spacing, preset = "detail";
  AttributeChoice attributes;
  bool index_field = false;
  bool order = false;
  bool allow_partial = false;
  CommonOptions common;
};

SampleSize size_of(const SampleArguments& arguments, double diagonal) {
  SampleSize size;
  if (!arguments.count.empty()) size.count = parse_count("count", arguments.count);
  if (!arguments.ratio.empty()) size.ratio = parse_ratio("ratio", arguments.ratio);
  if (!arguments.spacing.empty()) size.spacing = parse_length("spacing", arguments.spacing).resolve(diagonal);
  validate(size);
  return size;
}

// The chosen points in file order, with the columns that were asked for.
Geometry assemble(const Geometry& geometry, std::span<const Index> ranking, const SampleArguments& arguments) {
  std::vector<Index> rank(ranking.size());
  std::iota(rank.begin(), rank.end(), Index{0});
  std::sort(rank.begin(), rank.end(), [&](Index a, Index b) { return ranking[a] < ranking[b]; });
  std::vector<Index> kept(ranking.begin(), ranking.end());
  std::sort(kept.begin(), kept.end());
  Geometry sampled = select_points(geometry, kept);
  if (arguments.index_field) sampled.attributes.set({"source_index", kept});
  if (arguments.order) sampled.attributes.set({"order", rank});
  return sampled;
}

// As many points as there are, when fewer can be reached than were asked for and that is allowed.
struct Outcome {
  SampleResult sample;
  bool is_partial = false;
};
Outcome sample_within_reach(const Geometry& geometry, const SampleSize& size, const SampleOptions& options,
                            bool allow_partial, Run& run) {
  try {
    return {sample(geometry, size, options, run.context()), false};
  } catch (const TargetUnreachable& error) {
    if (!allow_partial || error.reachable() == 0) throw;
    run.warn(error.what());
    return {sample(geometry, {.count = error.reachable(), .ratio = {}, .spacing = {}}, options, run.context()), true};
  }
}

int run_sample(const SampleArguments& arguments, const DescribedFlags<SampleOptions>& flags, std::stop_token stop) {
  Run run("sample", arguments.common, std::move(stop));
  (void)size_of(arguments, 1.0);  // bad usage is told before anything is read
  SampleOptions options = sample_preset(parse_enum<Preset>("preset", arguments.preset));
  flags.apply(options);
  if (flags.was_given("curvature-method") || flags.was_given("curvature-passes")) options.fields.adaptive = false;
  validate_options(options);
  run.check_output(arguments.output);

  Geometry geometry = run.read(arguments.input);
  run.check_output(arguments.output);
  run.check_memory(geometry.size() * kSampleBytesPerPoint);
  run.attributes_dropped = arguments.attributes.apply(geometry.attributes);
  const SampleSize size = size_of(arguments, bounding_box(geometry.positions).diagonal());
  const auto [result, is_partial] =
      run.timed("sample", [&] { return sample_within_reach(geometry, size, options, arguments.allow_partial, run); });

  run.warn(result.diagnostics);
  if (result.last_resort > 0) {
    run.warn(fmt::format("{} of the points chosen are strays or duplicates, since the count asks for so many",
                         result.last_resort));
  }
  run.write(arguments.output, assemble(geometry, result.indices, arguments));
  run.points_in = geometry.size();
  run.points_out = result.indices.size();
  run.options = options_json(options);
  run.options["preset"] = arguments.preset;
  if (size.count) run.options["count"] = *size.count;
  if (size.ratio) run.options["ratio"] = *size.ratio;
  if (size.spacing) run.options["spacing"] = *size.spacing;
  run.result = {{"kept", result.indices.size()},
                {"usable", result.usable},
                {"outliers", result.diagnostics.outliers},
                {"duplicates", result.diagnostics.duplicate_points},
                {"non_finite", result.diagnostics.non_finite_points},
                {"boundary", result.diagnostics.boundary_vertices},
                {"components", result.diagnostics.components},
                {"noise", result.noise},
                {"denoised", result.denoised}};
  run.say(fmt::format("{}: {} of {} points kept ({:.3g} %), method {}{}", arguments.output, result.indices.size(),
                      geometry.size(),
                      100.0 * static_cast<double>(result.indices.size()) / static_cast<double>(geometry.size()),
                      enum_name(options.method),
                      options.method == SamplingMethod::Shape ? fmt::format(" ({})", arguments.preset) : ""));
  run.finish();
  return is_partial ? kTargetUnreachable : 0;
}

}  // namespace

Command add_sample_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("sample", "Keep the points that carry the shape, exactly as many as asked for.");
  auto arguments = std::make_shared<SampleArguments>();
  command->add_option("input", arguments->input, "Mesh, range image or point cloud.")->required()->type_name("IN");
  command->add_option("-o,--output", arguments->output, "The points kept.")->required()->type_name("OUT");
  command->add_option("--count", arguments->count, "Points to keep: 1200, 50k, 2M.")->type_name("N");
  command->add_option("--ratio", arguments->ratio, "Share to keep: 0.1 or 10%.")->type_name("R");
  command->add_option("--spacing", arguments->spacing, "Spacing to keep, in the file's units or % of the diagonal.")
      ->type_name("S");
  command
      ->add_option("--preset", arguments->preset,
                   "detail, fast (no NLM, no Retinex) or paper (the literal paper). (detail)")
      ->type_name("detail|fast|paper");
  command->add_flag("--index-field", arguments->index_field, "Write source_index: the input index of each point.");
  command->add_flag("--order", arguments->order,
                    "Write order: 0 for the point chosen first; every prefix is a sample.");
  command->add_flag("--allow-partial", arguments->allow_partial,
                    "Write what there is when the count cannot be reached (exit code 5).");
  arguments->attributes.add_options(*command);
  auto flags = std::make_shared<DescribedFlags<SampleOptions>>(
      *command, std::initializer_list<std::string_view>{"method", "local-weight", "skip-boundary", "seed"});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_sample(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
