#include "shapelight/render/renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/panel.hpp"
#include "render/shade.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace drawing {
namespace {

constexpr Color kClay = {0.79F, 0.79F, 0.78F};

/// Dots as large as their number leaves room for. [pixels]
double dot_radius(const RenderItem& item, std::size_t drawn, int width, int height) {
  if (item.dot_radius > 0.0) return item.dot_radius;
  const double room = std::sqrt(0.4 * width * height / static_cast<double>(std::max<std::size_t>(drawn, 1)));
  return std::clamp(0.30 * room, 1.5, 4.5);
}

}  // namespace

void check_item(const RenderItem& item) {
  if (item.geometry == nullptr) throw InvalidInput("render: an item has no geometry");
  if (!item.colors.empty() && item.colors.size() != item.geometry->size()) {
    throw InvalidInput(
        fmt::format("render: {} colors for {} points, expected one each", item.colors.size(), item.geometry->size()));
  }
}

Image draw_panel(const RenderItem& item, const Camera& camera, int width, int height, const RenderOptions& options,
                 const RunContext& context) {
  const int samples = options.supersample;
  Camera fine = camera;
  fine.scale *= samples;
  fine.center_x *= samples;
  fine.center_y *= samples;
  context.report(0.0, "render: surface");
  const Surface surface = make_surface(item, context);
  context.report(0.4, "render: draw");
  const bool flat = item.flat_colors || item.legend.map == ColorMap::Categorical;
  const Paint paint{item.colors, kClay, flat, item.point_radius * samples};
  const Frame frame = rasterize(*item.geometry, surface, paint, fine, width * samples, height * samples, context);
  context.report(0.7, "render: light");
  const std::vector<float> ambient = ambient_light(frame, fine, samples, options.occlusion, context);
  const std::vector<Dot> dots = visible_dots(item.dots, frame, fine);
  const double radius = dot_radius(item, dots.size(), width, height);
  const DotStyle style{item.dot_color, static_cast<float>(radius * samples),
                       static_cast<float>(std::min(0.9, 0.35 * radius) * samples)};
  Image image = shade(frame, ambient, dots, style, options.background, samples, context);
  context.report(1.0, "render: light");
  return image;
}

}  // namespace drawing

Image render(const RenderItem& item, const RenderOptions& options, const RunContext& context) {
  validate_options(options);
  drawing::check_item(item);
  const View view = parse_view(options.view, *item.geometry);
  const auto camera = drawing::fit_camera(*item.geometry, view, options.width, options.height, options.field_of_view);
  return drawing::draw_panel(item, camera, options.width, options.height, options, context);
}

}  // namespace shapelight
