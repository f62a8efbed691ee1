#include "shapelight/graph/surface_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace shapelight {
namespace {

void require(bool holds, const char* what, std::size_t vertex) {
  if (!holds) throw std::logic_error(fmt::format("surface graph: vertex {}: {}", vertex, what));
}

void validate_vertex(const SurfaceGraph& graph, std::size_t i) {
  require(graph.position[i].allFinite(), "position is not finite", i);
  const double normal_length = graph.normal[i].norm();
  require(normal_length == 0.0 || std::abs(normal_length - 1.0) < 1e-6, "normal is neither unit nor zero", i);
  require(graph.area[i] >= 0.0 && std::isfinite(graph.area[i]), "area is negative or not finite", i);
  const auto neighbors = graph.neighbors_of(i);
  for (std::size_t k = 0; k < neighbors.size(); ++k) {
    const Index j = neighbors[k];
    require(j < graph.size(), "neighbour out of range", i);
    require(j != i, "is its own neighbour", i);
    require(k == 0 || neighbors[k - 1] < j, "neighbours are not ascending and unique", i);
    const auto back = graph.neighbors_of(j);
    require(std::binary_search(back.begin(), back.end(), static_cast<Index>(i)), "an edge is one-way", i);
  }
  require(graph.vertex_of_point[graph.global_id[i]] == i, "index maps disagree", i);
}

}  // namespace

void validate(const SurfaceGraph& graph) {
  const std::size_t n = graph.size();
  const bool sizes = graph.offsets.size() == n + 1 && graph.normal.size() == n && graph.area.size() == n &&
                     graph.boundary.size() == n && graph.outlier.size() == n && graph.global_id.size() == n &&
                     graph.weight.size() == graph.neighbors.size();
  require(sizes, "arrays differ in size", 0);
  require(graph.offsets.front() == 0 && graph.offsets.back() == graph.neighbors.size(), "offsets do not span", 0);
  for (std::size_t i = 0; i < n; ++i) validate_vertex(graph, i);
}

std::span<const Index> RingCollector::collect(Index center, int rings, std::size_t limit) {
  // Every visit writes its vertex behind the last one found and moves on only if it is new: no branch to mispredict.
  if (found_.size() < limit + 1) found_.resize(limit + 1);
  found_[0] = center;
  met_[center] = 1;
  std::size_t count = 1, ring_begin = 0;
  for (int ring = 0; ring < rings && count < limit; ++ring) {
    const std::size_t ring_end = count;
    for (std::size_t k = ring_begin; k < ring_end && count < limit; ++k) {
      for (const Index j : graph_->neighbors_of(found_[k])) {
        found_[count] = j;
        count += 1U - met_[j];
        met_[j] = 1;
        if (count == limit) break;
      }
    }
    ring_begin = ring_end;
  }
  const std::span<const Index> found(found_.data(), count);
  for (const Index j : found) met_[j] = 0;
  return found;
}

}  // namespace shapelight
