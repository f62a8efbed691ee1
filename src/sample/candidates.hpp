#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "shapelight/core/types.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/sample/sampling_target.hpp"

/// What all samplers do with their arguments.
namespace shapelight {

/// Throws InvalidInput unless the candidates are ascending vertices of the graph and the target fits them.
void check_sampling(const SurfaceGraph& graph, std::span<const Index> candidates, const SamplingTarget& target);

/// Throws InvalidInput that names the method when the target is not a count.
void require_count(const SamplingTarget& target, std::string_view method);

/// Positions of the candidates, in their order.
[[nodiscard]] std::vector<Vec3> gather_positions(const SurfaceGraph& graph, std::span<const Index> candidates);

/// Turns positions in the list of candidates into vertex indices, in place.
void to_vertices(std::span<const Index> candidates, std::vector<Index>& slots);

/// Random streams, one per purpose, so that samplers with the same seed are independent of each other.
enum SamplingStream : std::uint64_t {
  kRandomStream = 0x5a01,
  kStratifiedStream,
  kPoissonStream,
  kNormalStream,
  kNormalTurnStream,
  kFillStream,
};

}  // namespace shapelight
