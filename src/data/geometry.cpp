#include "shapelight/data/geometry.hpp"

#include <algorithm>

namespace shapelight {

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

GeometryKind Geometry::kind() const {
  if (!triangles.empty()) return GeometryKind::Mesh;
  return grid ? GeometryKind::RangeImage : GeometryKind::Cloud;
}

Geometry select_points(const Geometry& geometry, std::span<const Index> indices) {
  Geometry chosen;
  chosen.positions.resize(indices.size());
  std::transform(indices.begin(), indices.end(), chosen.positions.begin(),
                 [&](Index i) { return geometry.positions[i]; });
  chosen.coordinate_type = geometry.coordinate_type;
  chosen.attributes = geometry.attributes.gather(indices);
  chosen.viewpoint = geometry.viewpoint;
  chosen.comments = geometry.comments;
  chosen.las = geometry.las;
  chosen.format = geometry.format;
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
