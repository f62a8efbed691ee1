#include <fmt/format.h>

#include <filesystem>

#include "commands.hpp"
#include "described_options.hpp"
#include "run.hpp"
#include "shapelight/render/image.hpp"
#include "shapelight/render/panels.hpp"

namespace shapelight::cli {
namespace {

struct RenderArguments {
  std::vector<std::string> inputs;
  std::string output, view = "auto";
  std::vector<std::string> colors, dots;
  double point_size = 0.0;
  double dot_size = 0.0;
  CommonOptions common;
};

std::string stem(const std::string& path) { return std::filesystem::path(path).stem().string(); }

int run_render(const RenderArguments& arguments, const DescribedFlags<RenderOptions>& flags, std::stop_token stop) {
  Run run("render", arguments.common, std::move(stop));
  RenderOptions options;
  flags.apply(options);
  options.view = arguments.view;
  validate_options(options);
  if (std::filesystem::path(arguments.output).extension() != ".png") {
    throw InvalidInput(fmt::format("{}: pictures are written as .png", arguments.output));
  }
  run.check_output(arguments.output, false);

  std::vector<Geometry> geometries;
  for (const std::string& input : arguments.inputs) geometries.push_back(run.read(input));
  std::vector<Geometry> dots;
  for (const std::string& path : arguments.dots) dots.push_back(run.read(path));
  run.check_output(arguments.output, false);

  std::vector<NamedGeometry> inputs;
  for (std::size_t i = 0; i < geometries.size(); ++i) inputs.push_back({&geometries[i], stem(arguments.inputs[i])});
  std::vector<NamedDots> named_dots;
  for (std::size_t i = 0; i < dots.size(); ++i) named_dots.push_back({dots[i].positions, stem(arguments.dots[i])});
  const std::vector<std::string> colors =
      arguments.colors.empty() ? std::vector<std::string>{"none"} : arguments.colors;
  const std::vector<RenderItem> panels =
      make_panels(inputs, colors, named_dots, {.point = arguments.point_size, .dot = arguments.dot_size});
  const Image image = run.timed("render", [&] { return render_scene(panels, options, run.context()); });
  if (!arguments.common.dry_run) write_png(arguments.output, image, arguments.common.force);
  run.options = options_json(options);
  run.options["view"] = arguments.view;
  run.options["color"] = colors;
  run.result = {{"width", image.width}, {"height", image.height}, {"panels", panels.size()}};
  run.say(fmt::format("{}: {} x {} pixels, {} panels", arguments.output, image.width, image.height, panels.size()));
  run.finish();
  return 0;
}

}  // namespace

Command add_render_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Draw meshes, clouds and fields, shaded, side by side, to a PNG.");
  auto arguments = std::make_shared<RenderArguments>();
  command->add_option("input", arguments->inputs, "Meshes, range images, clouds.")->required()->type_name("IN...");
  command->add_option("-o,--output", arguments->output, "The picture.")->required()->type_name("PICTURE.png");
  command
      ->add_option("--color", arguments->colors,
                   "Fields to colour by, one panel each: an attribute, rgb, normal, x, y, z, or none.")
      ->type_name("FIELD")
      ->delimiter(',');
  command
      ->add_option("--view", arguments->view,
                   "auto, front, back, left, right, top, bottom, iso, or x,y,z of the eye. (auto)")
      ->type_name("FROM");
  command
      ->add_option("--dots", arguments->dots,
                   "Points to draw on top, such as a sample; of several files, a panel each.")
      ->type_name("FILE")
      ->delimiter(',');
  command->add_option("--point-size", arguments->point_size,
                      "Diameter of a cloud's points [pixels]; 0: by their spacing.");
  command->add_option("--dot-size", arguments->dot_size, "Diameter of the dots [pixels]; 0: by their number.");
  auto flags = std::make_shared<DescribedFlags<RenderOptions>>(
      *command, std::initializer_list<std::string_view>{"width", "height"});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_render(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
