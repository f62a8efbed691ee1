#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "io/text_scanner.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/render/renderer.hpp"

namespace shapelight {
namespace {

/// Up, and the side that faces the viewer in "front".
struct Orientation {
  Vec3 up, front;
  [[nodiscard]] Vec3 right() const { return up.cross(front); }
};
constexpr std::array<double, 3> kThreeQuarter = {1.0, 0.45, 0.35};  // shares of front, right, up
constexpr std::array<double, 3> kFromAbove = {1.0, 0.3, 1.1};

bool is_terrain(const Vec3& extent) { return extent.z() < 0.25 * std::min(extent.x(), extent.y()); }

/// The sensor, unless it stands amid its points, as a spinning lidar does: that is no place to look from.
/// An organised PCD whose header leaves the viewpoint at the origin was taken from there.
std::optional<Vec3> outside_sensor(const Geometry& geometry, const BoundingBox& box) {
  std::optional<Vec3> sensor = geometry.viewpoint;
  if (!sensor && geometry.grid && geometry.format == "pcd") sensor = Vec3::Zero();
  if (sensor && !((*sensor - box.center()).norm() > 0.35 * box.diagonal())) sensor.reset();
  return sensor;
}

Orientation orientation_of(const Geometry& geometry, const BoundingBox& box) {
  const Vec3 y = Vec3::UnitY();
  const Vec3 z = Vec3::UnitZ();
  if (const auto sensor = outside_sensor(geometry, box); sensor && geometry.grid) {
    const Vec3 into = box.center() - *sensor;
    if (into.z() > 0.7 * into.norm()) return {-y, -z};
    if (into.z() < -0.7 * into.norm()) return {y, z};
    return {z, -y};
  }
  if (geometry.grid && geometry.format != "ptx") return {y, z};
  const Vec3 extent = box.max - box.min;
  const bool laser = geometry.format == "las" || geometry.format == "ptx";
  const bool statue = extent.z() > 1.3 * std::max(extent.x(), extent.y());
  return laser || statue || is_terrain(extent) ? Orientation{z, -y} : Orientation{y, z};
}

Vec3 automatic_eye(const Geometry& geometry, const BoundingBox& box, const Orientation& o) {
  if (const auto sensor = outside_sensor(geometry, box)) return *sensor - box.center();
  if (geometry.grid && geometry.format != "ptx") return o.front;
  const auto& share = is_terrain(box.max - box.min) && o.up == Vec3::UnitZ() ? kFromAbove : kThreeQuarter;
  return share[0] * o.front + share[1] * o.right() + share[2] * o.up;
}

std::optional<Vec3> named_eye(std::string_view text, const Orientation& o) {
  if (text == "front") return o.front;
  if (text == "back") return -o.front;
  if (text == "right") return o.right();
  if (text == "left") return -o.right();
  if (text == "top") return o.up;
  if (text == "bottom") return -o.up;
  if (text == "iso") return o.front + o.right() + o.up;
  return std::nullopt;
}

Vec3 parse_eye(std::string_view text) {
  const std::string_view whole = text;
  Vec3 eye;
  bool good = true;
  for (int axis = 0; axis < 3; ++axis) {
    const auto end = axis < 2 ? text.find(',') : text.size();
    const auto number = end <= text.size() ? io::parse_double(text.substr(0, end)) : std::nullopt;
    good = good && number && std::isfinite(*number);
    if (!good) break;
    eye[axis] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!good || eye.norm() == 0.0) {
    throw InvalidInput(fmt::format(
        "view '{}' is not understood, expected auto, front, back, left, right, top, bottom, iso, or a direction x,y,z",
        whole));
  }
  return eye;
}

}  // namespace

View parse_view(std::string_view text, const Geometry& geometry) {
  const BoundingBox box = bounding_box(geometry.positions);
  const Orientation o = orientation_of(geometry, box);
  const auto named = named_eye(text, o);
  const Vec3 eye = text == "auto" ? automatic_eye(geometry, box, o) : named ? *named : parse_eye(text);
  View view;
  view.direction = -eye.normalized();
  if (text == "auto" && geometry.grid && outside_sensor(geometry, box)) view.distance = eye.norm();
  // Straight from above or below the front points down or up the picture.
  Vec3 up = o.up - o.up.dot(view.direction) * view.direction;
  if (up.norm() < 1e-6) up = view.direction.dot(o.up) < 0.0 ? Vec3(-o.front) : o.front;
  view.up = (up - up.dot(view.direction) * view.direction).normalized();
  return view;
}

}  // namespace shapelight
