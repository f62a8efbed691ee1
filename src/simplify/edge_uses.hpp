#pragma once

#include <algorithm>
#include <compare>
#include <numeric>
#include <span>
#include <vector>

#include "core/poll.hpp"
#include "shapelight/data/triangle_mesh.hpp"

namespace shapelight {

/// One side of a face.
struct EdgeUse {
  Index high;  ///< the other vertex; edges are listed at their lower one
  Index face;
  friend auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

/// The edges of all faces by their lower vertex, sorted there, so that uses of one edge stand together. Cost: O(n).
struct EdgeUses {
  std::vector<std::size_t> offsets;
  std::vector<EdgeUse> uses;

  EdgeUses(const TriangleMesh& mesh, const RunContext& context)
      : offsets(mesh.positions.size() + 1, 0), uses(3 * mesh.triangles.size()) {
    const auto for_edges = [&](auto&& visit) {
      for (Index f = 0; f < mesh.triangles.size(); ++f) {
        poll(context, f);
        for (std::size_t c = 0; c < 3; ++c) {
          const auto [low, high] = std::minmax(mesh.triangles[f][c], mesh.triangles[f][(c + 1) % 3]);
          visit(low, EdgeUse{high, f});
        }
      }
    };
    for_edges([&](Index low, const EdgeUse&) { ++offsets[low + 1]; });
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
    for_edges([&](Index low, const EdgeUse& use) { uses[next[low]++] = use; });
    for (std::size_t v = 0; v + 1 < offsets.size(); ++v) {
      poll(context, v);
      std::sort(begin_of(v), begin_of(v + 1));
    }
  }

  /// visit(low, high, uses), once per edge
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (Index low = 0; low + 1 < offsets.size(); ++low) {
      for (std::size_t i = offsets[low]; i < offsets[low + 1];) {
        std::size_t end = i + 1;
        while (end < offsets[low + 1] && uses[end].high == uses[i].high) ++end;
        visit(low, uses[i].high, std::span(uses).subspan(i, end - i));
        i = end;
      }
    }
  }

  [[nodiscard]] std::span<const EdgeUse> faces_at(Index a, Index b) const {
    const auto [low, high] = std::minmax(a, b);
    const auto begin = uses.begin() + static_cast<std::ptrdiff_t>(offsets[low]);
    const auto end = uses.begin() + static_cast<std::ptrdiff_t>(offsets[low + 1]);
    const auto first = std::lower_bound(begin, end, EdgeUse{high, 0});
    return {first, std::find_if(first, end, [high = high](const EdgeUse& use) { return use.high != high; })};
  }

 private:
  std::vector<EdgeUse>::iterator begin_of(std::size_t v) {
    return uses.begin() + static_cast<std::ptrdiff_t>(offsets[v]);
  }
};

}  // namespace shapelight
