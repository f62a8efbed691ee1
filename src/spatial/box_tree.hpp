#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight {

/// Axis-aligned box in single precision; whoever makes one rounds outwards.
struct Box {
  std::array<float, 3> min, max;
};

/// Four numbers that are added, multiplied and compared by one instruction (a vector type of GCC and Clang).
using Float4 = float __attribute__((vector_size(16)));

/// Four boxes side by side, so that one instruction measures the distance to all of them. The first child, the root's
/// too, is never empty; unused places hold NaN, which compares false with every bound.
struct alignas(128) BoxNode {
  static constexpr std::size_t kWidth = 4;
  static constexpr std::uint32_t kItem = 1U << 31;  ///< marks a child that is an item: its place in BoxTree::order
  std::array<Float4, 3> min, max;
  std::array<std::uint32_t, kWidth> child;
};

/// Bounding volume hierarchy over boxes: nodes[0] is the root, children follow their parent.
struct BoxTree {
  static constexpr std::size_t kMaxDepth = 72;
  /// A depth-first search that keeps the untested children of every level needs no more places than this.
  static constexpr std::size_t kMaxOpen = (BoxNode::kWidth - 1) * kMaxDepth + 1;
  std::vector<BoxNode> nodes;
  std::vector<Index> order;  ///< the item at each place
};

/// Splits by the surface area heuristic over 16 bins along the longest axis (Wald 2007), four ways at a time. Groups
/// below kMaxDepth / 2 are halved by count, which bounds the depth.
/// Pre:  1 to 2^31 - 1 boxes, all finite. Cost: O(n log n). The same tree for any number of threads.
[[nodiscard]] BoxTree build_box_tree(std::span<const Box> boxes, const RunContext& context);

}  // namespace shapelight
