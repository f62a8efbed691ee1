#pragma once

#include <optional>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight {

/// What registration sees of one scan: points, the surface's normal at each, and a tree over them. Coordinates should
/// be small (relative to the middle of the scan), so that large offsets cost no precision.
struct RegistrationCloud {
  /// Throws InvalidInput: a position is not finite, or normals are neither empty nor one per point.
  /// Cost: O(n log n); the spacing asks for one neighbour per point.
  explicit RegistrationCloud(std::vector<Vec3> positions, std::vector<Vec3> normals = {},
                             const RunContext& context = {});

  [[nodiscard]] std::size_t size() const { return position.size(); }

  std::vector<Vec3> position;  ///< n: [input length unit]
  std::vector<Vec3> normal;    ///< n or empty: unit, zero where undefined; those of the dense scan, not of its samples
  KdTree tree;                 ///< over `position`
  double spacing = 0.0;        ///< [input length unit] median distance to the nearest other place; 0 below two places
  double diagonal = 0.0;       ///< [input length unit] of the bounding box
  std::optional<Vec3> viewpoint;  ///< [input length unit] place of the sensor, when known; for assess_pose()
};

}  // namespace shapelight
