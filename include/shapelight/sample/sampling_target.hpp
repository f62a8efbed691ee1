#pragma once

#include <cstddef>

namespace shapelight {

/// How many points a sampler shall choose among its candidates; strays (SurfaceGraph::outlier) are for the caller to
/// leave out of them, since a grid and disks would choose each one. Exactly one member is set, the other is zero.
struct SamplingTarget {
  std::size_t count = 0;  ///< [points] met exactly
  double spacing = 0.0;   ///< [input length unit] cell size or minimum distance, by the method
};

/// Throws InvalidInput unless exactly one member is set, the spacing is finite and positive, and the count at most
/// `num_candidates`.
void validate(const SamplingTarget& target, std::size_t num_candidates);

}  // namespace shapelight
