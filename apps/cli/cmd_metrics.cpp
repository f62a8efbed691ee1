#include <fmt/format.h>

#include <filesystem>
#include <numbers>

#include "commands.hpp"
#include "described_options.hpp"
#include "run.hpp"
#include "shapelight/pipeline/measure.hpp"

namespace shapelight::cli {
namespace {

struct MetricsArguments {
  std::string reference, test, output;
  CommonOptions common;
};

nlohmann::ordered_json to_json(const DistanceSummary& d) { return {{"mean", d.mean}, {"rms", d.rms}, {"max", d.max}}; }

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

void print_length(std::string_view name, double length, double diagonal) {
  fmt::print("{:<24}{:<14.6g}{:.4g} % of the diagonal\n", name, length, 100.0 * length / diagonal);
}

void report_surfaces(const SurfaceDistance& d, Run& run) {
  const double share = 1.0 / d.diagonal;
  const std::array<std::pair<const char*, const DistanceSummary*>, 3> directions = {
      {{"forward", &d.forward}, {"backward", &d.backward}, {"symmetric", &d.symmetric}}};
  for (const auto& [name, distance] : directions) run.result[name] = to_json(*distance);
  for (const auto& [name, distance] : directions) run.result["relative"][name] = to_json(distance->scaled(share));
  run.result["rmse"] = d.forward.rms;
  run.result["vertex_rms"] = d.vertex_rms;
  run.result["normal_deviation_deg"] = {{"rms", degrees(d.normal_deviation.rms)},
                                        {"p95", degrees(d.normal_deviation.p95)}};
  run.result["diagonal"] = d.diagonal;
  run.result["samples"] = d.samples;
  if (run.common().json == "-") return;
  for (const auto& [name, distance] : directions) {
    print_length(fmt::format("{} mean", name), distance->mean, d.diagonal);
    print_length(fmt::format("{} rms", name), distance->rms, d.diagonal);
    print_length(fmt::format("{} max", name), distance->max, d.diagonal);
  }
  print_length("vertex rms", d.vertex_rms, d.diagonal);
  fmt::print("{:<24}{:.4g} deg rms, {:.4g} deg at 95 %\n", "normal deviation", degrees(d.normal_deviation.rms),
             degrees(d.normal_deviation.p95));
}

void report_points(const SamplingQuality& q, double diagonal, Run& run) {
  run.result = {{"coverage_max", q.coverage_max},
                {"coverage_mean", q.coverage_mean},
                {"feature_coverage_max", q.feature_coverage_max},
                {"feature_coverage_mean", q.feature_coverage_mean},
                {"feature_share", q.feature_share},
                {"spacing_mean", q.spacing_mean},
                {"spacing_min", q.spacing_min},
                {"spacing_cv", q.spacing_cv}};
  if (run.common().json == "-") return;
  print_length("coverage max", q.coverage_max, diagonal);
  print_length("coverage mean", q.coverage_mean, diagonal);
  print_length("feature coverage max", q.feature_coverage_max, diagonal);
  print_length("feature coverage mean", q.feature_coverage_mean, diagonal);
  print_length("spacing mean", q.spacing_mean, diagonal);
  print_length("spacing min", q.spacing_min, diagonal);
  fmt::print("{:<24}{:.4g}\n{:<24}{:.4g} %\n", "spacing variation", q.spacing_cv, "samples on features",
             100.0 * q.feature_share);
}

int run_metrics(const MetricsArguments& arguments, const DescribedFlags<SurfaceDistanceOptions>& flags,
                std::stop_token stop) {
  Run run("metrics", arguments.common, std::move(stop));
  SurfaceDistanceOptions options;
  flags.apply(options);
  validate_options(options);
  const bool wants_distances = !arguments.output.empty();
  if (wants_distances) run.check_output(arguments.output);
  const Geometry reference = run.read(arguments.reference);
  Geometry test = run.read(arguments.test);
  if (wants_distances) run.check_output(arguments.output);
  run.points_in = reference.size();
  run.points_out = test.size();

  std::vector<double> distances;  // first: a reference without a surface is told before anything is printed
  if (wants_distances) {
    distances = run.timed("vertex distances", [&] { return distances_to_surface(reference, test, run.context()); });
  }
  const MeasureResult measured = run.timed("measure", [&] { return measure(reference, test, options, run.context()); });
  for (const std::string& warning : measured.warnings) run.warn(warning);
  if (measured.surfaces) {
    run.options = options_json(options);
    report_surfaces(*measured.surfaces, run);
  } else {
    report_points(*measured.points, measured.diagonal, run);
  }
  if (wants_distances) {
    test.attributes.set({"distance", std::move(distances)});
    run.write(arguments.output, test);
  }
  run.finish();
  return 0;
}

}  // namespace

Command add_metrics_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "metrics", "Measure how far two surfaces are apart, or how well the points of TEST cover those of REFERENCE.");
  auto arguments = std::make_shared<MetricsArguments>();
  command->add_option("reference", arguments->reference, "The whole: mesh, range image or cloud.")->required();
  command->add_option("test", arguments->test, "What is measured against it: a simplified mesh, or a sample.")
      ->required();
  command
      ->add_option("-o,--output,--distances", arguments->output,
                   "Write TEST with the column distance: of every vertex to the surface of REFERENCE.")
      ->type_name("OUT");
  command->footer(
      "Meshes and range images are measured as surfaces: forward from REFERENCE to TEST, backward, and both together.\n"
      "With a cloud on either side, points are measured: coverage and spacing. Features are the tenth of the "
      "reference\n"
      "with the largest surface variation over 30 neighbours.");
  auto flags = std::make_shared<DescribedFlags<SurfaceDistanceOptions>>(
      *command, std::initializer_list<std::string_view>{"samples", "seed"});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_metrics(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
