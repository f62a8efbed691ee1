#include <fmt/format.h>

#include "attribute_choice.hpp"
#include "commands.hpp"
#include "run.hpp"

namespace shapelight::cli {
namespace {

struct ConvertArguments {
  std::string input, output;
  bool ascii = false;
  AttributeChoice attributes;
  CommonOptions common;
};

int run_convert(const ConvertArguments& arguments, std::stop_token stop) {
  Run run("convert", arguments.common, std::move(stop));
  run.check_output(arguments.output);
  Geometry geometry = run.read(arguments.input);
  run.check_output(arguments.output);
  run.attributes_dropped = arguments.attributes.apply(geometry.attributes);
  run.write(arguments.output, geometry, arguments.ascii);
  run.points_in = run.points_out = geometry.size();
  run.options = {{"ascii", arguments.ascii}};
  run.say(fmt::format("{}: {} points, {} faces", arguments.output, geometry.size(), geometry.triangles.size()));
  run.finish();
  return 0;
}

}  // namespace

Command add_convert_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("convert", "Write a file in another format.");
  auto arguments = std::make_shared<ConvertArguments>();
  command->add_option("input", arguments->input, "Mesh, range image or point cloud.")->required()->type_name("IN");
  command->add_option("output", arguments->output, "The same in the format of this extension.")
      ->required()
      ->type_name("OUT");
  command->add_flag("--ascii", arguments->ascii, "Text where the format has both text and binary.");
  arguments->attributes.add_options(*command);
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_convert(*arguments, std::move(stop)); }};
}

}  // namespace shapelight::cli
