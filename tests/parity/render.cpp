#include "recorder.hpp"
#include "shapelight/render/panels.hpp"

namespace shapelight::parity {
namespace {

void record_image(const Recorder& recorder, const std::string& name, const Image& image) {
  recorder.record(name, image.pixels);
}

void record_colors(const Recorder& recorder) {
  const std::vector<double> values = {-1.0, 0.0, 0.25, 3.0, 1.0 / 3.0};
  recorder.record("color_by_values", color_by_values(values, "balance").colors);
  std::vector<Color> mapped, distinct, from_lab;
  std::vector<std::array<double, 3>> lab;
  for (const double v : values) mapped.push_back(map_color(ColorMap::BlueYellow, v));
  for (const std::int64_t label : {-1, 0, 1, 1000}) distinct.push_back(distinct_color(label));
  for (const Color& c : mapped) lab.push_back(to_oklab(c));
  for (const auto& c : lab) from_lab.push_back(from_oklab(c));
  recorder.record("map_color", mapped);
  recorder.record("distinct_color", distinct);
  recorder.record("to_oklab", lab);
  recorder.record("from_oklab", from_lab);
  const ValueRange range = value_range(values);
  recorder.record("value_range", std::vector<double>{range.min, range.max});
  recorder.record("channels", std::vector<double>{srgb_to_linear(0.3), linear_to_srgb(0.3)});
}

}  // namespace

void record_render(const Recorder& recorder) {
  const Geometry fandisk = data("meshes/fandisk.off"), bunny = data("scans/bun000_quarter.rif");
  RenderOptions options;
  options.width = 320;
  options.height = 240;
  options.view = "iso";
  options.occlusion = 0.5;
  const std::vector<NamedGeometry> inputs = {{&fandisk, "fandisk"}, {&bunny, "bun000_quarter"}};
  const std::vector<std::string> colors = {"none", "z"};
  const std::vector<NamedDots> dots = {{std::span(fandisk.positions).first(40), ""}};
  const std::vector<RenderItem> panels = make_panels(inputs, colors, dots, {.point = 0.0, .dot = 3.0});
  record_image(recorder, "render_scene", render_scene(panels, options));
  const Image alone = render(panels[1], options);
  record_image(recorder, "render", alone);
  record_image(recorder, "image_grid", image_grid(std::vector<Image>{alone, alone, alone}, 2, 5, {9, 8, 7}));
  recorder.record("color_by_field", color_by_field(fandisk, "y").colors);
  const View view = parse_view("1,2,3", bunny);
  recorder.record("parse_view", std::vector<Vec3>{view.direction, view.up});
  record_colors(recorder);
}

}  // namespace shapelight::parity
