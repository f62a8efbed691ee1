#pragma once

#include <cstdint>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/render/renderer.hpp"

namespace shapelight::drawing {

using Vec3f = Eigen::Vector3f;

inline constexpr int kSubpixels = 256;  ///< vertices snap to this fraction of a pixel, so coverage is exact arithmetic

/// A projected point. nearness = distance of the scene's centre / distance of the point: linear on the screen, larger
/// is nearer, 1 at the centre, 0 for a point that cannot be drawn.
struct ScreenPoint {
  std::int32_t x = 0;  ///< [1/256 pixel]
  std::int32_t y = 0;  ///< [1/256 pixel] downwards
  float nearness = 0.0F;
};

/// A pinhole camera. Camera frame: origin at the scene's centre, x right, y up, z towards the eye.
struct Camera {
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< rows: right, up, towards the eye
  double distance = 1.0;                               ///< from eye to centre
  double scale = 1.0;                                  ///< [pixels per length unit] at the centre
  double center_x = 0.0;                               ///< [pixels] where the centre appears
  double center_y = 0.0;

  [[nodiscard]] ScreenPoint project(const Vec3& point) const;
  /// The point of the camera frame that is seen at a place on the screen.
  [[nodiscard]] Vec3f unproject(float x, float y, float nearness) const {
    const float per_pixel = 1.0F / (static_cast<float>(scale) * nearness);
    const auto d = static_cast<float>(distance);
    return {(x - static_cast<float>(center_x)) * per_pixel, (static_cast<float>(center_y) - y) * per_pixel,
            d - d / nearness};
  }
  [[nodiscard]] Vec3f rotate(const Vec3f& direction) const { return axes.cast<float>() * direction; }
};

/// The camera that shows all finite points, but for far strays of a cloud, as large as a margin of 4 % allows. Throws
/// InvalidInput without any.
Camera fit_camera(const Geometry& geometry, const View& view, int width, int height, double field_of_view_deg);

}  // namespace shapelight::drawing
