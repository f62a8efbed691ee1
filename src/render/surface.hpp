#pragma once

#include <span>
#include <vector>

#include "render/camera.hpp"

namespace shapelight::drawing {

/// What is drawn of an item: triangles, or else one disc per point.
struct Surface {
  std::span<const Triangle> triangles;  ///< empty: discs
  std::vector<Triangle> own_triangles;  ///< of a range image
  std::vector<Vec3f> normals;           ///< per point, input frame, unit; zero where undefined
  std::vector<float> radius;            ///< [input length unit] per point; of discs only
};

/// Throws InvalidInput for normals of the wrong number and triangles that name missing vertices.
Surface make_surface(const RenderItem& item, const RunContext& context);

/// Triangles over the pixels of a range image, without those that span a depth jump: an edge longer than six times
/// the median step between pixels, which grows with the distance from the sensor.
std::vector<Triangle> triangulate_grid(const Geometry& geometry, const RunContext& context);

/// Unit vertex normals, weighted by the angles of the triangles around, so that how a flat part is
/// cut into triangles does not matter.
std::vector<Vec3f> triangle_normals(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                    const RunContext& context);

}  // namespace shapelight::drawing
