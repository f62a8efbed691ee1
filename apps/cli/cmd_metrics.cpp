#include <fmt/format.h>

#include <filesystem>
#include <numbers>

#include "commands.hpp"
#include "described_options.hpp"
#include "run.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/metrics/surface_distance.hpp"

namespace shapelight::cli {
namespace {

struct MetricsArguments {
  std::string reference, test, output;
  CommonOptions common;
};

// The surface of a mesh or a range image; no triangles of a cloud.
TriangleMesh surface_of(const Geometry& geometry) {
  if (!geometry.grid || !geometry.triangles.empty()) return {geometry.positions, geometry.triangles};
  return {geometry.positions,
          range_image_triangles(geometry.positions, *geometry.grid, geometry.viewpoint, GraphOptions{}.depth_jump)};
}

// Triangles at points that were never measured are no surface.
void drop_unmeasured(TriangleMesh& mesh, const std::string& path, Run& run) {
  const std::size_t dropped = std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return !(mesh.positions[t[0]].allFinite() && mesh.positions[t[1]].allFinite() && mesh.positions[t[2]].allFinite());
  });
  if (dropped > 0) run.warn(fmt::format("{}: {} triangles at non-finite vertices: ignored", path, dropped));
}

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

std::vector<Vec3> finite_points(const Geometry& geometry) {
  std::vector<Vec3> points;
  for (const Vec3& p : geometry.positions) {
    if (p.allFinite()) points.push_back(p);
  }
  return points;
}

void measure_points(const Geometry& reference_geometry, const Geometry& test_geometry, Run& run) {
  const std::vector<Vec3> reference = finite_points(reference_geometry), test = finite_points(test_geometry);
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
  if (run.common().json == "-") return;
  const double diagonal = bounding_box(reference).diagonal();
  print_length("coverage max", q.coverage_max, diagonal);
  print_length("coverage mean", q.coverage_mean, diagonal);
  print_length("feature coverage max", q.feature_coverage_max, diagonal);
  print_length("feature coverage mean", q.feature_coverage_mean, diagonal);
  print_length("spacing mean", q.spacing_mean, diagonal);
  print_length("spacing min", q.spacing_min, diagonal);
  fmt::print("{:<24}{:.4g}\n{:<24}{:.4g} %\n", "spacing variation", q.spacing_cv, "samples on features",
             100.0 * q.feature_share);
}

void write_distances(const MetricsArguments& arguments, Geometry test, const TriangleMesh& reference, Run& run) {
  const TriangleMesh points{test.positions, {}};
  test.attributes.set({"distance", run.timed("vertex distances", [&] {
                         const RunContext context = run.context();
                         return vertex_distances(points, TriangleTree(reference, context), context);
                       })});
  run.write(arguments.output, test);
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

  TriangleMesh reference_surface = surface_of(reference), test_surface = surface_of(test);
  drop_unmeasured(reference_surface, arguments.reference, run);
  drop_unmeasured(test_surface, arguments.test, run);
  if (wants_distances && reference_surface.triangles.empty()) {
    throw InvalidInput(fmt::format("{}: has no triangles, expected a surface for --output", arguments.reference));
  }
  if (reference_surface.triangles.empty() || test_surface.triangles.empty()) {
    measure_points(reference, test, run);
  } else {
    run.options = options_json(options);
    run.points_in = reference.size();
    run.points_out = test.size();
    report_surfaces(
        run.timed("measure",
                  [&] { return measure_surface_distance(reference_surface, test_surface, options, run.context()); }),
        run);
  }
  if (wants_distances) write_distances(arguments, std::move(test), reference_surface, run);
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
