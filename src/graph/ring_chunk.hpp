#pragma once

#include <algorithm>

#include "core/parallel.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Vertices per chunk of a loop that holds a RingCollector, so that setting those up costs at most 256 bytes per vertex
/// in all. Depends on the graph only, so results do not depend on threads.
[[nodiscard]] inline std::size_t ring_chunk(const SurfaceGraph& graph) {
  return std::max(parallel::kDefaultChunk, graph.size() / 256);
}

}  // namespace shapelight
