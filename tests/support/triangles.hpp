#pragma once

#include "shapelight/data/triangle_mesh.hpp"
#include "support/random_points.hpp"
#include "support/shapes.hpp"

namespace shapelight::testing {

inline TriangleMesh mesh_of(const Shape& shape) { return {shape.positions, shape.triangles}; }

/// `count` unconnected triangles, of edges up to `size`, in the unit cube.
inline TriangleMesh random_triangles(std::size_t count, double size, std::uint64_t seed) {
  TriangleMesh mesh;
  const std::vector<Vec3> centers = test::random_points(count, seed), shifts = test::random_points(3 * count, seed + 1);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) mesh.positions.push_back(centers[t] + size * shifts[3 * t + k]);
    const auto first = static_cast<Index>(3 * t);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace shapelight::testing
