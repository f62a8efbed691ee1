#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight::simplification {

/// A face seen from one of its vertices: the face is (vertex, next, previous).
struct Wedge {
  Index next, previous;
};

/// The wedges of every vertex, flat.
struct Wedges {
  std::vector<Index> offset;  ///< vertices + 1
  std::vector<Wedge> items;
  [[nodiscard]] std::size_t num_vertices() const { return offset.size() - 1; }
  [[nodiscard]] std::span<Wedge> at(std::size_t v) { return {items.data() + offset[v], offset[v + 1] - offset[v]}; }
  [[nodiscard]] std::span<const Wedge> at(std::size_t v) const {
    return {items.data() + offset[v], offset[v + 1] - offset[v]};
  }
};

/// In order of the triangles at every vertex. Pre: no index out of range.
[[nodiscard]] Wedges collect_wedges(std::size_t num_vertices, std::span<const Triangle> triangles,
                                    const RunContext& context);

enum class Fan : std::uint8_t {
  Closed,    ///< the faces go once around the vertex
  Open,      ///< the faces form one strip from border to border
  Irregular  ///< anything else: several fans, a neighbour met twice, faces that disagree
};

/// Sorts the wedges of a vertex counter-clockwise: the previous vertex of one is the next vertex of the following one.
/// An open fan begins at its border, a closed one at its first wedge. Cost: quadratic for few, n log n for many.
[[nodiscard]] Fan order_fan(std::span<Wedge> wedges);

}  // namespace shapelight::simplification
