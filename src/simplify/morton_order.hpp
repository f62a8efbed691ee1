#pragma once

#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight::simplification {

/// Indices of the points along a Morton curve through their box: near in space is near in order.
/// Pre: scale (position - low) is within [0, 1] on each axis. Ties keep the order of the indices. Cost: linear.
[[nodiscard]] std::vector<Index> morton_order(std::span<const Vec3> positions, const Vec3& low, double scale,
                                              const RunContext& context);

}  // namespace shapelight::simplification
