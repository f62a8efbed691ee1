#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/registration/registration_cloud.hpp"

namespace shapelight {

/// A scan at even density: the mean point and the mean normal of every cubic cell that holds points with a normal.
struct ThinnedScan {
  std::vector<Vec3> position;         ///< n: [input length unit]
  std::vector<Vec3> normal;           ///< n: unit
  std::vector<Index> index_of_point;  ///< per point of the scan: which of the n it went into, kNoIndex when in none
};

/// Pre: the cloud has normals; `cell` is a millionth of its diagonal or more. Cost: O(n log n).
[[nodiscard]] ThinnedScan thin_scan(const RegistrationCloud& cloud, double cell, const RunContext& context);

/// The number of cubic cells that hold points. Pre: as above.
[[nodiscard]] std::size_t count_cells(std::span<const Vec3> points, double cell);

}  // namespace shapelight
