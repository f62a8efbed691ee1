#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sample/cell_grid.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

/// The two ways to spread points that the samplers share.
namespace shapelight {

/// Dart throwing: goes through `order` (slots of the grid) and takes each point that lies at least `radius` away from
/// all taken before. Returns slots, in the order taken; appends nothing past `limit` points, which leaves holes. Pre:
/// radius <= grid.cell().
[[nodiscard]] std::vector<std::uint32_t> throw_darts(const CellGrid& grid, std::span<const std::uint32_t> order,
                                                     double radius, std::size_t limit, const RunContext& context);

/// Adds farthest points to `chosen` (indices into `points`) until there are `count`; ties in hashed order, which does
/// not follow the surface. `reach` is about the largest distance from a point to a chosen one; it only affects speed.
/// Pre: chosen not empty, unique.  Cost: O(n log n) and O(points within reach) for each added point.
void fill_farthest(std::span<const Vec3> points, std::size_t count, double reach, std::vector<Index>& chosen,
                   const RunContext& context);

}  // namespace shapelight
