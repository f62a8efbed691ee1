#include <fmt/format.h>

#include "commands.hpp"
#include "run.hpp"

namespace shapelight::cli {
namespace {

struct InfoArguments {
  std::string input;
  CommonOptions common;
};

nlohmann::ordered_json attribute_list(const AttributeTable& table) {
  auto list = nlohmann::ordered_json::array();
  for (const Column& column : table.columns()) {
    list.push_back({{"name", column.name}, {"type", scalar_type_name(column.type())}});
  }
  return list;
}

int run_info(const InfoArguments& arguments, std::stop_token stop) {
  Run run("info", arguments.common, std::move(stop));
  const Geometry geometry = run.read(arguments.input);
  const BoundingBox box = bounding_box(geometry.positions);
  std::size_t finite = 0;
  for (const Vec3& p : geometry.positions) finite += p.allFinite();
  run.points_in = geometry.size();
  const auto vector = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  run.result = {{"kind", geometry_kind_name(geometry.kind())},
                {"points", geometry.size()},
                {"finite_points", finite},
                {"faces", geometry.triangles.size()},
                {"coordinate_type", scalar_type_name(geometry.coordinate_type)},
                {"bounds", {{"min", vector(box.min)}, {"max", vector(box.max)}, {"diagonal", box.diagonal()}}},
                {"attributes", attribute_list(geometry.attributes)},
                {"face_attributes", attribute_list(geometry.triangle_attributes)},
                {"comments", geometry.comments}};
  if (geometry.grid) run.result["grid"] = {{"width", geometry.grid->width}, {"height", geometry.grid->height}};
  if (geometry.viewpoint) run.result["viewpoint"] = vector(*geometry.viewpoint);
  if (arguments.common.json != "-") {
    fmt::print("{}: {} ({})\n  points      {} ({} finite), {}\n  faces       {}\n", arguments.input,
               geometry_kind_name(geometry.kind()), geometry.format, geometry.size(), finite,
               scalar_type_name(geometry.coordinate_type), geometry.triangles.size());
    if (geometry.grid) fmt::print("  grid        {} x {} pixels\n", geometry.grid->width, geometry.grid->height);
    fmt::print("  bounds      {:.10g} {:.10g} {:.10g} .. {:.10g} {:.10g} {:.10g}, diagonal {:.6g}\n", box.min.x(),
               box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z(), box.diagonal());
    for (const Column& column : geometry.attributes.columns()) {
      fmt::print("  attribute   {} ({})\n", column.name, scalar_type_name(column.type()));
    }
    for (const Column& column : geometry.triangle_attributes.columns()) {
      fmt::print("  per face    {} ({})\n", column.name, scalar_type_name(column.type()));
    }
  }
  run.finish();
  return 0;
}

}  // namespace

Command add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Say what is in a file.");
  auto arguments = std::make_shared<InfoArguments>();
  command->add_option("input", arguments->input, "Mesh, range image or point cloud.")->required()->type_name("IN");
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_info(*arguments, std::move(stop)); }};
}

}  // namespace shapelight::cli
