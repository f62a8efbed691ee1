#include <fmt/format.h>

#include "commands.hpp"
#include "run.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/metrics/sampling_quality.hpp"

namespace shapelight::cli {
namespace {

struct MetricsArguments {
  std::string reference, test;
  CommonOptions common;
};

std::vector<Vec3> finite_points(const Geometry& geometry) {
  std::vector<Vec3> points;
  for (const Vec3& p : geometry.positions) {
    if (p.allFinite()) points.push_back(p);
  }
  return points;
}

int run_metrics(const MetricsArguments& arguments, std::stop_token stop) {
  Run run("metrics", arguments.common, std::move(stop));
  const std::vector<Vec3> reference = finite_points(run.read(arguments.reference));
  const std::vector<Vec3> test = finite_points(run.read(arguments.test));
  const RunContext context = run.context();
  const SamplingQuality q = run.timed("measure", [&] {
    const std::vector<double> importance = surface_variation_knn(reference, 30, context);
    return measure_sampling(reference, importance, test, context);
  });
  run.points_in = reference.size();
  run.points_out = test.size();
  run.result = {{"coverage_max", q.coverage_max},
                {"coverage_mean", q.coverage_mean},
                {"feature_coverage_max", q.feature_coverage_max},
                {"feature_coverage_mean", q.feature_coverage_mean},
                {"feature_share", q.feature_share},
                {"spacing_mean", q.spacing_mean},
                {"spacing_min", q.spacing_min},
                {"spacing_cv", q.spacing_cv}};
  if (arguments.common.json != "-") {
    const double diagonal = bounding_box(reference).diagonal();
    const auto line = [&](std::string_view name, double length) {
      fmt::print("{:<24}{:<14.6g}{:.4g} % of the diagonal\n", name, length, 100.0 * length / diagonal);
    };
    line("coverage max", q.coverage_max);
    line("coverage mean", q.coverage_mean);
    line("feature coverage max", q.feature_coverage_max);
    line("feature coverage mean", q.feature_coverage_mean);
    line("spacing mean", q.spacing_mean);
    line("spacing min", q.spacing_min);
    fmt::print("{:<24}{:.4g}\n{:<24}{:.4g} %\n", "spacing variation", q.spacing_cv, "samples on features",
               100.0 * q.feature_share);
  }
  run.finish();
  return 0;
}

}  // namespace

Command add_metrics_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("metrics", "Measure how well the points of TEST cover those of REFERENCE.");
  auto arguments = std::make_shared<MetricsArguments>();
  command->add_option("reference", arguments->reference, "The whole: mesh, range image or cloud.")->required();
  command->add_option("test", arguments->test, "The sample.")->required();
  command->footer("Features are the tenth of the reference with the largest surface variation over 30 neighbours.");
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_metrics(*arguments, std::move(stop)); }};
}

}  // namespace shapelight::cli
