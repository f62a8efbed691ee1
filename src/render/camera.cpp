#include "render/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

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

namespace {

struct Frustum {
  double width, height;  // usable part of the picture [pixels]
  double focal;          // [pixels]
};

/// How far the eye must be for all points to lie within the frustum about the centre.
double fitting_distance(const std::vector<Vec3>& points, const Frustum& frustum) {
  double distance = 0.0;
  for (const Vec3& p : points) {
    const double aside = std::max(std::abs(p.x()) / frustum.width, std::abs(p.y()) / frustum.height);
    distance = std::max(distance, p.z() + 2.0 * frustum.focal * aside);
  }
  return distance;
}

/// The box that the picture shows. Clouds often have a few far strays: the box of their middle 98 % per axis, with a
/// quarter added at each side, cuts those off and leaves compact things whole.
BoundingBox framed_box(const Geometry& geometry) {
  BoundingBox box = bounding_box(geometry.positions);
  if (!geometry.triangles.empty()) return box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values(geometry.size());
    std::transform(geometry.positions.begin(), geometry.positions.end(), values.begin(),
                   [&](const Vec3& p) { return p[axis]; });
    const ValueRange middle = value_range(values);
    const double extra = 0.25 * (middle.max - middle.min);
    box.min[axis] = std::max(box.min[axis], middle.min - extra);
    box.max[axis] = std::min(box.max[axis], middle.max + extra);
  }
  return box;
}

}  // namespace

Camera fit_camera(const Geometry& geometry, const View& view, int width, int height, double field_of_view_deg) {
  Camera camera;
  camera.axes.row(0) = view.direction.cross(view.up);
  camera.axes.row(1) = view.up;
  camera.axes.row(2) = -view.direction;
  const BoundingBox box = framed_box(geometry);
  camera.center = view.distance > 0.0 ? bounding_box(geometry.positions).center() : box.center();
  std::vector<Vec3> points;  // camera frame
  for (const Vec3& p : geometry.positions) {
    const bool framed = (p.array() >= box.min.array()).all() && (p.array() <= box.max.array()).all();
    if (framed && p.allFinite()) points.push_back(camera.axes * (p - camera.center));
  }
  if (points.empty()) throw InvalidInput("render: the geometry has no finite point, expected at least one");

  constexpr double kShown = 1.0 - 2.0 * 0.04;  // a margin of 4 % on every side
  const double tangent = std::tan(0.5 * field_of_view_deg * std::numbers::pi / 180.0);
  const Frustum frustum = {kShown * width, kShown * height, 0.5 * kShown * std::min(width, height) / tangent};
  camera.distance = view.distance > 0.0 ? view.distance : fitting_distance(points, frustum);
  if (camera.distance <= 0.0) camera.distance = 1.0;  // a single point

  // Perspective moves the middle of the picture away from the middle of the box: centre what is seen, and enlarge it.
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Array2d low = Eigen::Array2d::Constant(kInfinity);
  Eigen::Array2d high = -low;
  for (const Vec3& p : points) {
    if (p.z() > 0.99 * camera.distance) continue;  // beside or behind an eye amid the points
    const Eigen::Array2d seen = p.head<2>().array() * camera.distance / (camera.distance - p.z());
    low = low.min(seen);
    high = high.max(seen);
  }
  const Eigen::Array2d extent = high - low;
  camera.scale = extent.maxCoeff() > 0.0 ? std::min(frustum.width / extent.x(), frustum.height / extent.y())
                                         : frustum.focal / camera.distance;
  const Eigen::Array2d middle =
      extent.maxCoeff() >= 0.0 ? Eigen::Array2d(0.5 * (low + high) * camera.scale) : Eigen::Array2d::Zero();
  camera.center_x = 0.5 * width - middle.x();
  camera.center_y = 0.5 * height + middle.y();
  return camera;
}

}  // namespace shapelight::drawing
