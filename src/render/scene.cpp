#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/panel.hpp"
#include "render/text.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using drawing::Camera;
constexpr Pixel kInk = {45, 45, 48};

/// Sizes of a picture's parts. [pixels]
struct Layout {
  int columns = 1, rows = 1;
  int panel_width = 0, panel_height = 0;  // of the drawing alone
  int caption_height = 0, legend_height = 0;
  double text = 0.0;  // height of a capital letter
};

bool has_bar(const RenderItem& item) { return !item.legend.name.empty(); }

Layout make_layout(std::span<const RenderItem> items, const RenderOptions& options) {
  Layout layout;
  const int count = static_cast<int>(items.size());
  layout.columns = count <= 3 ? count : static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
  layout.rows = (count + layout.columns - 1) / layout.columns;
  layout.panel_width = options.width / layout.columns;
  const int cell_height = options.height / layout.rows;
  layout.text = std::clamp(0.022 * std::min(2 * layout.panel_width, options.height), 7.0, 28.0);
  const auto any = [&](auto&& test) { return std::any_of(items.begin(), items.end(), test); };
  if (any([](const RenderItem& i) { return !i.title.empty(); }))
    layout.caption_height = static_cast<int>(2.4 * layout.text);
  if (any(has_bar)) layout.legend_height = static_cast<int>(3.6 * layout.text);
  layout.panel_height = cell_height - layout.caption_height - layout.legend_height;
  if (layout.panel_width < 16 || layout.panel_height < 16) {
    throw InvalidInput(
        fmt::format("render: {} x {} pixels leave {} x {} for each of {} panels, expected at least 16 x 16",
                    options.width, options.height, layout.panel_width, layout.panel_height, count));
  }
  return layout;
}

/// Text as large as fits into `room`, its middle at `center`.
void draw_centered(Image& image, std::string_view text, double center, double baseline, double size, double room) {
  const double width = drawing::text_width(text, size);
  const double fit = width > room ? size * room / width : size;
  drawing::draw_text(image, text, center - 0.5 * std::min(width, room), baseline, fit, kInk);
}

std::string number(double value) { return fmt::format("{:.3g}", value == 0.0 ? 0.0 : value); }

/// min [bar] max, over the field's name.
void draw_legend(Image& image, const Legend& legend, int top, double text) {
  const double center = 0.5 * image.width;
  const double room = 0.94 * image.width;
  const double first_baseline = top + 1.4 * text;
  if (legend.map == ColorMap::Categorical) {
    draw_centered(image, legend.name, center, first_baseline, 0.9 * text, room);
    return;
  }
  const int bar_left = static_cast<int>(0.27 * image.width), bar_right = image.width - bar_left;
  const int bar_top = top + static_cast<int>(0.3 * text), bar_bottom = bar_top + static_cast<int>(1.1 * text);
  for (int x = bar_left; x < bar_right; ++x) {
    const Color color = map_color(legend.map, (x - bar_left + 0.5) / (bar_right - bar_left));
    Pixel pixel;
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(color[c] * 255.0F + 0.5F);
    for (int y = bar_top; y < bar_bottom; ++y) image.at(x, y) = pixel;
  }
  const double side = 0.25 * image.width;
  const std::string low = number(legend.min), high = number(legend.max);
  const double size =
      0.85 * text *
      std::min({1.0, side / drawing::text_width(low, 0.85 * text), side / drawing::text_width(high, 0.85 * text)});
  drawing::draw_text(image, low, bar_left - 0.6 * text - drawing::text_width(low, size), first_baseline, size, kInk);
  drawing::draw_text(image, high, bar_right + 0.6 * text, first_baseline, size, kInk);
  draw_centered(image, legend.name, center, top + 3.0 * text, 0.9 * text, room);
}

/// Whether two things fill nearly the same box, as a scan and its simplification do.
bool comparable(const BoundingBox& a, const BoundingBox& b) {
  const double size = std::max(a.diagonal(), b.diagonal());
  return (a.center() - b.center()).norm() <= 0.05 * size && std::abs(a.diagonal() - b.diagonal()) <= 0.10 * size;
}

std::vector<Camera> make_cameras(std::span<const RenderItem> items, const RenderOptions& options,
                                 const Layout& layout) {
  std::vector<Camera> cameras;
  const BoundingBox first_box = bounding_box(items.front().geometry->positions);
  for (const RenderItem& item : items) {
    if (!cameras.empty() && comparable(first_box, bounding_box(item.geometry->positions))) {
      cameras.push_back(cameras.front());
      continue;
    }
    const View view = parse_view(options.view, *item.geometry);
    cameras.push_back(
        drawing::fit_camera(*item.geometry, view, layout.panel_width, layout.panel_height, options.field_of_view));
  }
  return cameras;
}

}  // namespace

Image render_scene(std::span<const RenderItem> items, const RenderOptions& options, const RunContext& context) {
  validate_options(options);
  if (items.empty()) throw InvalidInput("render: no items, expected at least one");
  for (const RenderItem& item : items) drawing::check_item(item);
  const Layout layout = make_layout(items, options);
  const std::vector<Camera> cameras = make_cameras(items, options, layout);
  Image picture(options.width, options.height, options.background);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto share = [&](std::size_t k) { return static_cast<double>(k) / static_cast<double>(items.size()); };
    const RunContext part = context.phase(share(i), share(i + 1), "render");
    const Image shaded =
        drawing::draw_panel(items[i], cameras[i], layout.panel_width, layout.panel_height, options, part);
    Image panel(layout.panel_width, options.height / layout.rows, options.background);
    paste(panel, shaded, 0, 0);
    draw_centered(panel, items[i].title, 0.5 * panel.width, layout.panel_height + 1.6 * layout.text, layout.text,
                  0.94 * panel.width);
    if (has_bar(items[i]))
      draw_legend(panel, items[i].legend, layout.panel_height + layout.caption_height, layout.text);
    const int column = static_cast<int>(i) % layout.columns, row = static_cast<int>(i) / layout.columns;
    paste(picture, panel, column * panel.width, row * panel.height);
  }
  return picture;
}

}  // namespace shapelight
