#pragma once

#include <vector>

#include "core/random.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight::test {

/// `count` points, uniform in the unit cube.
inline std::vector<Vec3> random_points(std::size_t count, std::uint64_t seed) {
  std::vector<Vec3> points(count);
  for (std::size_t i = 0; i < count; ++i) points[i] = {random01(seed, 0, i), random01(seed, 1, i), random01(seed, 2, i)};
  return points;
}

}  // namespace shapelight::test
