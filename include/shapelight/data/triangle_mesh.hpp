#pragma once

#include <vector>

#include "shapelight/core/types.hpp"

namespace shapelight {

/// Positions and triangles, nothing else: what algorithms on surfaces take and return.
struct TriangleMesh {
  std::vector<Vec3> positions;  ///< [input length unit]
  std::vector<Triangle> triangles;
};

}  // namespace shapelight
