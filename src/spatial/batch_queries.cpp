#include "shapelight/spatial/batch_queries.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kChunk = 256;  // queries: a wide radius makes each of them slow

void check_radius(double radius) {
  if (!(radius >= 0.0)) throw InvalidInput(fmt::format("radius: {}, expected a length >= 0", radius));
}

}  // namespace

std::vector<Neighbor> nearest(const KdTree& tree, std::span<const Vec3> queries, std::size_t k, double radius,
                              const RunContext& context) {
  check_radius(radius);
  std::vector<Neighbor> table(queries.size() * k, Neighbor{std::numeric_limits<double>::infinity(), kNoIndex});
  parallel::for_chunks(
      context, queries.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<Neighbor> found;
        for (std::size_t i = begin; i < end; ++i) {
          tree.nearest(queries[i], k, found, radius * radius);
          std::copy(found.begin(), found.end(), table.begin() + static_cast<std::ptrdiff_t>(i * k));
        }
      },
      kChunk);
  return table;
}

NeighborLists within(const KdTree& tree, std::span<const Vec3> queries, double radius, const RunContext& context) {
  check_radius(radius);
  NeighborLists lists;
  lists.offsets.assign(queries.size() + 1, 0);
  std::vector<std::vector<Neighbor>> parts((queries.size() + kChunk - 1) / kChunk);
  parallel::for_chunks(
      context, queries.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<Neighbor>& part = parts[begin / kChunk];
        std::vector<Neighbor> found;
        for (std::size_t i = begin; i < end; ++i) {
          tree.within(queries[i], radius, found);
          part.insert(part.end(), found.begin(), found.end());
          lists.offsets[i + 1] = found.size();
        }
      },
      kChunk);
  for (std::size_t i = 0; i < queries.size(); ++i) lists.offsets[i + 1] += lists.offsets[i];
  lists.found.reserve(lists.offsets.back());
  for (std::vector<Neighbor>& part : parts) {
    lists.found.insert(lists.found.end(), part.begin(), part.end());
    std::vector<Neighbor>().swap(part);
  }
  return lists;
}

std::vector<TriangleTree::RayHit> first_hits(const TriangleTree& tree, std::span<const Vec3> origins,
                                             std::span<const Vec3> directions, const RunContext& context) {
  if (origins.size() != directions.size()) {
    throw InvalidInput(
        fmt::format("rays: {} origins and {} directions, expected as many", origins.size(), directions.size()));
  }
  std::vector<TriangleTree::RayHit> hits(origins.size());
  parallel::for_chunks(
      context, origins.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) hits[i] = tree.first_hit(origins[i], directions[i]);
      },
      kChunk);
  return hits;
}

}  // namespace shapelight
