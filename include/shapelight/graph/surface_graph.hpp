#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/data/geometry.hpp"

namespace shapelight {

/// THE neighbourhood. Every stage works on this and never asks whether a mesh, a range image or a raw cloud made it.
///
/// Vertices are the distinct finite positions of the input in a canonical order (Morton order, ties by coordinates),
/// so results do not depend on the order of the input and neighbours lie close in memory. Isolated vertices stay.
/// Neighbours of i: neighbors[offsets[i] .. offsets[i + 1]), ascending, no self edges, symmetric.
struct SurfaceGraph {
  std::vector<std::uint32_t> offsets;  ///< n + 1
  std::vector<Index> neighbors;        ///< m
  std::vector<float> weight;   ///< m: [area] of the triangles at the edge; sums to 6 x area over a vertex's edges
  std::vector<Vec3> position;  ///< n: relative to `origin`, [input length unit]
  std::vector<Vec3> normal;    ///< n: unit, consistently oriented; zero where undefined
  std::vector<double> area;    ///< n: [input length unit squared] surface that the vertex stands for
  std::vector<std::uint8_t> boundary;  ///< n: 1 on the border of an open surface
  std::vector<std::uint8_t> outlier;   ///< n: 1 for strays; samplers choose them last
  std::vector<Index> global_id;        ///< n: input index of the vertex (lowest of its duplicates)
  std::vector<Index> vertex_of_point;  ///< input index -> vertex; kNoIndex for a non-finite point
  Vec3 origin = Vec3::Zero();          ///< centre of the bounding box, input frame
  double mean_edge_length = 0.0;       ///< h, [input length unit]; over edges
  double total_area = 0.0;             ///< sum of area

  [[nodiscard]] std::size_t size() const { return position.size(); }
  [[nodiscard]] std::span<const Index> neighbors_of(std::size_t i) const {
    return {neighbors.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
};

/// Oddities met while a graph was built; counts, for the user's eyes.
struct GraphDiagnostics {
  std::size_t non_finite_points = 0;
  std::size_t duplicate_points = 0;      ///< points at exactly the place of an earlier one
  std::size_t isolated_vertices = 0;     ///< vertices without any neighbour
  std::size_t outliers = 0;              ///< flagged strays; isolated vertices only when far from the surface
  std::size_t non_manifold_edges = 0;    ///< edges of more than two triangles
  std::size_t degenerate_triangles = 0;  ///< left out: a repeated vertex or no area
  std::size_t boundary_vertices = 0;
  std::size_t components = 0;  ///< connected components, isolated vertices not counted
};

/// Checks every invariant of the graph; throws std::logic_error that names the first broken one. For tests.
void validate(const SurfaceGraph& graph);

/// Rings around a vertex by breadth-first search. One instance per chunk of work, which should hold graph.size() / 256
/// vertices or more; buffers are reused between calls. Holds one byte per vertex of the graph.
class RingCollector {
 public:
  explicit RingCollector(const SurfaceGraph& graph) : graph_(&graph), met_(graph.size(), 0) {}
  /// Vertices within `rings` steps of `center`, itself first, then ring by ring, each ring in the order of discovery
  /// (neighbours ascending); at most `limit` in all. The span is valid until the next call. Cost: their degrees.
  std::span<const Index> collect(Index center, int rings, std::size_t limit);

 private:
  const SurfaceGraph* graph_;
  std::vector<Index> found_;
  std::vector<std::uint8_t> met_;  // 1 for the vertices of found_ during a call
};

}  // namespace shapelight
