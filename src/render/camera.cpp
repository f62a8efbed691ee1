#include "render/camera.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shapelight/core/error.hpp"

namespace shapelight::drawing {

ScreenPoint Camera::project(const Vec3& point) const {
  const Vec3 p = axes * (point - center);
  const double depth = distance - p.z();
  if (!(depth > 1e-3 * distance)) return {};  // behind the eye, or not finite
  const double nearness = distance / depth;
  const double x = (center_x + scale * nearness * p.x()) * kSubpixels;
  const double y = (center_y - scale * nearness * p.y()) * kSubpixels;
  constexpr double kFarOutside = 1 << 24;  // products of two such differences still fit 64 bits
  if (!(std::abs(x) < kFarOutside && std::abs(y) < kFarOutside)) return {};
  return {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y)),
          static_cast<float>(nearness)};
}

Camera fit_camera(const Geometry& geometry, const View& view, int width, int height, double field_of_view_deg) {
  Camera camera;
  camera.axes.row(0) = view.direction.cross(view.up);
  camera.axes.row(1) = view.up;
  camera.axes.row(2) = -view.direction;
  // The box in the camera frame, relative to the first finite point so that large offsets lose nothing.
  const auto first = std::find_if(geometry.positions.begin(), geometry.positions.end(), [](const Vec3& p) { return p.allFinite(); });
  if (first == geometry.positions.end()) throw InvalidInput("render: the geometry has no finite point, expected at least one");
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
  for (const Vec3& p : geometry.positions) {
    if (!p.allFinite()) continue;
    const Vec3 q = camera.axes * (p - *first);
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  camera.center = *first + camera.axes.transpose() * (0.5 * (low + high));
  constexpr double kMargin = 0.04;
  const double usable_width = width * (1.0 - 2.0 * kMargin);
  const double usable_height = height * (1.0 - 2.0 * kMargin);
  const double tangent = std::tan(0.5 * field_of_view_deg * std::numbers::pi / 180.0);
  const double focal = 0.5 * std::min(usable_width, usable_height) / tangent;  // [pixels]
  const double slope_x = 0.5 * usable_width / focal;
  const double slope_y = 0.5 * usable_height / focal;
  double distance = 0.0;
  for (const Vec3& p : geometry.positions) {
    if (!p.allFinite()) continue;
    const Vec3 q = camera.axes * (p - camera.center);
    distance = std::max({distance, q.z() + std::abs(q.x()) / slope_x, q.z() + std::abs(q.y()) / slope_y});
  }
  camera.distance = distance > 0.0 ? distance : 1.0;  // a single point
  camera.scale = focal / camera.distance;
  camera.center_x = 0.5 * width;
  camera.center_y = 0.5 * height;
  return camera;
}

}  // namespace shapelight::drawing
