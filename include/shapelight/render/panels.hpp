#pragma once

#include <span>
#include <string>
#include <vector>

#include "shapelight/render/renderer.hpp"

namespace shapelight {

/// A geometry, and what captions call it: usually its file.
struct NamedGeometry {
  const Geometry* geometry = nullptr;
  std::string name{};
};

/// Points to draw on top, such as a sample.
struct NamedDots {
  std::span<const Vec3> positions{};  ///< input frame
  std::string name{};
};

/// How large points are drawn.
struct PointSizes {
  double point = 0.0;  ///< [pixels] diameter of a cloud's points; 0: by their spacing
  double dot = 0.0;    ///< [pixels] diameter of the dots; 0: by their number
};

/// The panels of a picture for render_scene(): every geometry in every colour ("none": neutral, else see
/// color_by_field(); no colours: neutral), under every set of dots. Captions say what differs.
/// The geometries must outlive the panels. Throws InvalidInput (no such field, a size that is negative or not finite).
[[nodiscard]] std::vector<RenderItem> make_panels(std::span<const NamedGeometry> geometries,
                                                  std::span<const std::string> colors = {},
                                                  std::span<const NamedDots> dots = {}, const PointSizes& sizes = {});

}  // namespace shapelight
