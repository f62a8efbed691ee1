#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/spatial/kd_tree.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

/// Queries of many points at once, in parallel; each answer is that of the single query. Fastest when points that
/// follow each other are close. They throw InvalidInput (a radius that is negative or NaN) and Cancelled.
namespace shapelight {

/// The k nearest points of every query, nearest first: queries x k. Where there are fewer, also because of `radius`,
/// the index is kNoIndex and the distance infinite.
[[nodiscard]] std::vector<Neighbor> nearest(const KdTree& tree, std::span<const Vec3> queries, std::size_t k,
                                            double radius = std::numeric_limits<double>::infinity(),
                                            const RunContext& context = {});

/// Those of query i are found[offsets[i] .. offsets[i + 1]), nearest first.
struct NeighborLists {
  std::vector<std::uint64_t> offsets;  ///< queries + 1
  std::vector<Neighbor> found;
};

/// All points with distance <= radius of every query.
[[nodiscard]] NeighborLists within(const KdTree& tree, std::span<const Vec3> queries, double radius,
                                   const RunContext& context = {});

/// Where every ray first meets a triangle. Throws InvalidInput unless there is one direction for each origin.
[[nodiscard]] std::vector<TriangleTree::RayHit> first_hits(const TriangleTree& tree, std::span<const Vec3> origins,
                                                           std::span<const Vec3> directions,
                                                           const RunContext& context = {});

}  // namespace shapelight
