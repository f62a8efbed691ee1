#pragma once

#include <span>
#include <vector>

#include "shapelight/core/types.hpp"

namespace shapelight {

/// Positions and triangles, nothing else: what algorithms on surfaces take and return.
struct TriangleMesh {
  std::vector<Vec3> positions;  ///< [input length unit]
  std::vector<Triangle> triangles;
};

/// A mesh whose arrays somebody else holds; they must outlive it.
struct MeshView {
  std::span<const Vec3> positions;  ///< [input length unit]
  std::span<const Triangle> triangles;

  MeshView(std::span<const Vec3> mesh_positions, std::span<const Triangle> mesh_triangles)
      : positions(mesh_positions), triangles(mesh_triangles) {}
  MeshView(const TriangleMesh& mesh) : MeshView(mesh.positions, mesh.triangles) {}
};

}  // namespace shapelight
