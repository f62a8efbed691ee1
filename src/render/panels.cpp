#include "shapelight/render/panels.hpp"

#include <fmt/format.h>

#include <cmath>

#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

void require_size(const char* what, double pixels) {
  if (std::isfinite(pixels) && pixels >= 0.0) return;
  throw InvalidInput(fmt::format("{} size: {} pixels, expected 0 or more", what, pixels));
}

void extend(std::string& title, const char* separator, const std::string& text) {
  if (!title.empty() && !text.empty()) title += separator;
  title += text;
}

RenderItem colored_item(const NamedGeometry& input, const std::string& color, const PointSizes& sizes) {
  RenderItem item;
  item.geometry = input.geometry;
  item.title = input.name;
  item.point_radius = 0.5 * sizes.point;
  item.dot_radius = 0.5 * sizes.dot;
  if (color == "none") return item;
  extend(item.title, ": ", color);
  FieldColors field = color_by_field(*input.geometry, color);
  item.colors = std::move(field.colors);
  item.legend = std::move(field.legend);
  return item;
}

}  // namespace

std::vector<RenderItem> make_panels(std::span<const NamedGeometry> geometries, std::span<const std::string> colors,
                                    std::span<const NamedDots> dots, const PointSizes& sizes) {
  require_size("point", sizes.point);
  require_size("dot", sizes.dot);
  const std::string none = "none";
  if (colors.empty()) colors = {&none, 1};
  std::vector<RenderItem> panels;
  for (const NamedGeometry& input : geometries) {
    for (const std::string& color : colors) {
      const RenderItem plain = colored_item(input, color, sizes);
      if (dots.empty()) panels.push_back(plain);
      for (const NamedDots& d : dots) {
        RenderItem& panel = panels.emplace_back(plain);
        panel.dots.assign(d.positions.begin(), d.positions.end());
        if (dots.size() > 1) extend(panel.title, ", ", d.name);
      }
    }
  }
  return panels;
}

}  // namespace shapelight
