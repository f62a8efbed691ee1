#include <fmt/format.h>

#include <numbers>

#include "commands.hpp"
#include "described_options.hpp"
#include "matrix_json.hpp"
#include "output_folder.hpp"
#include "run.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/synthetic/virtual_scan.hpp"

namespace shapelight::cli {
namespace {

constexpr std::uint64_t kBytesPerTriangle = 400;  // mesh, tree and what is read
constexpr std::uint64_t kBytesPerPixel = 80;
constexpr double kDegree = std::numbers::pi / 180.0;

struct ScanArguments {
  std::string input, output;
  int views = 1;
  double azimuth = 0.0, elevation = 15.0, field_of_view = 30.0;
  CommonOptions common;
};

// One scan and the files that it goes to.
struct View {
  std::string scan_name, pose_name;
  VirtualScanOptions options;
  VirtualCamera camera;
};

// "scan_00.ply" in a folder, or the file that was named.
std::vector<View> plan_views(const ScanArguments& arguments, const BoundingSphere& sphere,
                             const VirtualScanOptions& options, const std::optional<std::string>& file_name) {
  const std::vector<VirtualCamera> cameras =
      ring_of_cameras(sphere, arguments.views, arguments.azimuth * kDegree, arguments.elevation * kDegree,
                      arguments.field_of_view * kDegree);
  std::vector<View> views;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string name = file_name.value_or(fmt::format("scan_{:02}.ply", i));
    View view{name, std::filesystem::path(name).replace_extension(".pose.txt").string(), options, cameras[i]};
    view.options.seed += i;  // every view has noise and a frame of its own
    views.push_back(std::move(view));
  }
  return views;
}

bool is_single_file(const ScanArguments& arguments) {
  const std::filesystem::path output = arguments.output;
  if (!output.has_extension() || std::filesystem::is_directory(output)) return false;
  check_writable_format(output);
  if (arguments.views != 1) {
    throw InvalidInput(
        fmt::format("--views: {} scans do not fit into one file, expected a folder as --output", arguments.views));
  }
  return true;
}

void check_arguments(const ScanArguments& arguments) {
  const auto require = [](std::string_view option, double value, double min, double max) {
    if (!(value >= min && value <= max)) {
      throw InvalidInput(fmt::format("--{}: {:g}, expected {:g} .. {:g}", option, value, min, max));
    }
  };
  require("views", arguments.views, 1, 1000);
  require("azimuth", arguments.azimuth, -360, 360);
  require("elevation", arguments.elevation, -90, 90);
  require("fov", arguments.field_of_view, 1, 170);
}

// Scans, writes, and says what was seen: one entry of the report.
nlohmann::ordered_json make_scan(const TriangleTree& surface, const View& view, OutputFolder& folder, Run& run) {
  const VirtualScan scan =
      run.timed("scan", [&] { return virtual_scan(surface, view.camera, view.options, run.context()); });
  if (scan.geometry.size() == 0) run.warn(fmt::format("{}: the camera sees nothing", view.scan_name));
  run.points_out = run.points_out.value_or(0) + scan.geometry.size();
  if (!run.common().dry_run) {
    run.write(folder.staged(view.scan_name), scan.geometry);
    write_transform(folder.staged(view.pose_name), scan.T_mesh_scan);
  }
  return {{"scan", view.scan_name},
          {"pose", view.pose_name},
          {"points", scan.geometry.size()},
          {"T_mesh_scan", matrix_json(scan.T_mesh_scan.matrix())}};
}

int run_scan(const ScanArguments& arguments, const DescribedFlags<VirtualScanOptions>& flags, std::stop_token stop) {
  Run run("scan", arguments.common, std::move(stop));
  check_arguments(arguments);  // bad usage is told before anything is read
  VirtualScanOptions options;
  flags.apply(options);
  validate_options(options);
  const bool single = is_single_file(arguments);
  const std::filesystem::path output = arguments.output;
  const std::filesystem::path target = single ? output.parent_path() : output;

  const Geometry geometry = run.read(arguments.input);
  if (geometry.triangles.empty()) {
    throw InvalidInput(fmt::format("{}: has no triangles, expected a mesh to scan", arguments.input));
  }
  flags.apply(options, bounding_box(geometry.positions).diagonal());
  const std::vector<View> views = plan_views(arguments, bounding_sphere(geometry.positions), options,
                                             single ? std::optional(output.filename().string()) : std::nullopt);
  for (const View& view : views) {
    run.check_output(target / view.scan_name);
    run.check_output(target / view.pose_name, false);
  }
  run.check_memory(kBytesPerTriangle * geometry.triangles.size() +
                   kBytesPerPixel * static_cast<std::uint64_t>(options.width) * options.height);
  const TriangleTree surface({geometry.positions, geometry.triangles}, run.context());

  OutputFolder folder(target.empty() ? "." : target);
  run.result["views"] = nlohmann::ordered_json::array();
  for (const View& view : views) run.result["views"].push_back(make_scan(surface, view, folder, run));
  if (!arguments.common.dry_run) folder.commit();

  run.points_in = geometry.size();
  run.options = options_json(options);
  run.options["views"] = arguments.views;
  run.options["azimuth"] = arguments.azimuth;
  run.options["elevation"] = arguments.elevation;
  run.options["fov"] = arguments.field_of_view;
  run.say(fmt::format("{}: {} scan{}, {} points", arguments.output, views.size(), views.size() == 1 ? "" : "s",
                      *run.points_out));
  run.finish();
  return 0;
}

}  // namespace

Command add_scan_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("scan", "Scan a mesh with a virtual range camera; where it stood is known.");
  auto arguments = std::make_shared<ScanArguments>();
  command->add_option("input", arguments->input, "Mesh to scan.")->required()->type_name("MESH");
  command
      ->add_option("-o,--output", arguments->output,
                   "Folder for scan_00.ply, scan_00.pose.txt (scan into mesh), ...; or one file for one view.")
      ->required()
      ->type_name("DIR");
  command->add_option("--views", arguments->views, "Cameras on a ring about the object, y up. (1)")->type_name("N");
  command->add_option("--azimuth", arguments->azimuth, "Of the first camera, from z towards x [degrees]. (0)")
      ->type_name("X");
  command->add_option("--elevation", arguments->elevation, "Of all cameras [degrees]. (15)")->type_name("X");
  command->add_option("--fov", arguments->field_of_view, "Field of view; the object fills it [degrees]. (30)")
      ->type_name("X");
  auto flags = std::make_shared<DescribedFlags<VirtualScanOptions>>(
      *command, std::initializer_list<std::string_view>{"width", "height", "noise", "quantization", "dropout",
                                                        "max-incidence", "random-pose", "seed"});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_scan(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
