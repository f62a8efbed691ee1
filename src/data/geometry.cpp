#include "shapelight/data/geometry.hpp"

#include <algorithm>
#include <type_traits>
#include <variant>

namespace shapelight {
namespace {

void rotate_normals(AttributeTable& attributes, const Eigen::Matrix3d& rotation) {
  Column* x = attributes.find("nx");
  Column* y = attributes.find("ny");
  Column* z = attributes.find("nz");
  if (x == nullptr || y == nullptr || z == nullptr) return;
  std::vector<std::array<double, 3>> rotated(x->size());
  for (std::size_t i = 0; i < rotated.size(); ++i) {
    const Vec3 normal = rotation * Vec3(x->as_double(i), y->as_double(i), z->as_double(i));
    rotated[i] = {normal.x(), normal.y(), normal.z()};
  }
  const std::array<Column*, 3> columns{x, y, z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::visit(
        [&](auto& values) {
          using Value = typename std::remove_reference_t<decltype(values)>::value_type;
          for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<Value>(rotated[i][axis]);
        },
        columns[axis]->values);
  }
}

}  // namespace

void transform_geometry(Geometry& geometry, const RigidTransform& T_new_old) {
  for (Vec3& position : geometry.positions) position = T_new_old * position;
  if (geometry.viewpoint) geometry.viewpoint = T_new_old * *geometry.viewpoint;
  rotate_normals(geometry.attributes, T_new_old.linear());
  rotate_normals(geometry.triangle_attributes, T_new_old.linear());
}

std::string_view geometry_kind_name(GeometryKind kind) {
  switch (kind) {
    case GeometryKind::Mesh:
      return "mesh";
    case GeometryKind::RangeImage:
      return "range_image";
    case GeometryKind::Cloud:
      break;
  }
  return "cloud";
}

GeometryKind Geometry::kind() const { return GeometryView(*this).kind(); }

GeometryView::GeometryView(const Geometry& geometry)
    : positions(geometry.positions),
      triangles(geometry.triangles),
      grid(geometry.grid ? &*geometry.grid : nullptr),
      viewpoint(geometry.viewpoint),
      whole(&geometry) {}

GeometryKind GeometryView::kind() const {
  if (!triangles.empty()) return GeometryKind::Mesh;
  return grid != nullptr ? GeometryKind::RangeImage : GeometryKind::Cloud;
}

const Geometry& GeometryView::rest() const {
  static const Geometry none;
  return whole != nullptr ? *whole : none;
}

std::vector<GeometryView> views_of(std::span<const Geometry> geometries) {
  return {geometries.begin(), geometries.end()};
}

Geometry select_points(const GeometryView& geometry, std::span<const Index> indices) {
  Geometry chosen;
  chosen.positions.resize(indices.size());
  std::transform(indices.begin(), indices.end(), chosen.positions.begin(),
                 [&](Index i) { return geometry.positions[i]; });
  chosen.viewpoint = geometry.viewpoint;
  const Geometry& rest = geometry.rest();
  chosen.coordinate_type = rest.coordinate_type;
  chosen.attributes = rest.attributes.gather(indices);
  chosen.comments = rest.comments;
  chosen.las = rest.las;
  chosen.format = rest.format;
  return chosen;
}

BoundingBox bounding_box(std::span<const Vec3> positions) {
  BoundingBox box;
  bool first = true;
  for (const Vec3& p : positions) {
    if (!p.allFinite()) continue;
    box.min = first ? p : Vec3(box.min.cwiseMin(p));
    box.max = first ? p : Vec3(box.max.cwiseMax(p));
    first = false;
  }
  return box;
}

}  // namespace shapelight
