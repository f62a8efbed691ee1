#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Disjoint sets that also know, for every element, whether it agrees (0) or disagrees (1) in sign with its set's root.
class SignedUnionFind {
 public:
  explicit SignedUnionFind(std::size_t count) : parent_(count), sign_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  /// Root of i, and the sign of i relative to it.
  std::pair<Index, std::uint8_t> find(Index i) {
    std::uint8_t sign = 0;
    while (parent_[i] != i) {
      const Index up = parent_[i];
      sign_[i] ^= sign_[up];  // path halving: i now hangs from its grandparent (sign_ of a root is 0)
      sign ^= sign_[i];
      parent_[i] = parent_[up];
      i = parent_[i];
    }
    return {i, sign};
  }
  /// Joins the sets of a and b so that a and b differ in sign by `differ`; false when they were one set already.
  /// The lower root stays root.
  bool unite(Index a, Index b, std::uint8_t differ = 0) {
    auto [root_a, sign_a] = find(a);
    auto [root_b, sign_b] = find(b);
    if (root_a == root_b) return false;
    if (root_b < root_a) std::swap(root_a, root_b);
    parent_[root_b] = root_a;
    sign_[root_b] = static_cast<std::uint8_t>(sign_a ^ sign_b ^ differ);
    return true;
  }

 private:
  std::vector<Index> parent_;
  std::vector<std::uint8_t> sign_;
};

/// For every vertex the lowest vertex of its connected component.
[[nodiscard]] std::vector<Index> component_roots(const SurfaceGraph& graph, const RunContext& context);

}  // namespace shapelight
