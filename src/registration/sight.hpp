#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"

namespace shapelight::registration {

/// How far a sensor saw in each direction: the nearest range per cell of a cube map around its place. Everything nearer
/// is free space.
class Sight {
 public:
  /// Pre: the cloud's viewpoint is known.
  explicit Sight(const RegistrationCloud& cloud);

  struct Count {
    std::size_t seen_through = 0;  ///< points that stand in free space
    std::size_t in_sight = 0;      ///< points in directions where something was seen
  };
  /// Of points in the cloud's frame; those that stand in front of what was seen by less than `margin` are on it.
  [[nodiscard]] Count count(std::span<const Vec3> points, const RigidTransform& T_cloud_points, double margin,
                            const RunContext& context) const;

 private:
  [[nodiscard]] std::size_t cell_of(const Vec3& direction) const;

  Vec3 viewpoint_;
  std::size_t resolution_ = 0;  // cells along a side of a cube's face
  std::vector<float> nearest_;  // 6 x resolution^2; 0: nothing was seen
};

}  // namespace shapelight::registration
