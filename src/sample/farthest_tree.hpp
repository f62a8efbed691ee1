#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight {

/// Exact weighted farthest points on a static kd-tree. Every node knows the largest squared distance d to the chosen
/// points below it, and the largest w d; so the next pick is read off the root, and choosing a point visits only the
/// boxes that it may bring closer. Serial, hence independent of threads; ties go to the lowest index.
/// Eldar et al. 1997 (farthest point strategy) with a density w: spacing goes with w^(-1/2).
class FarthestTree {
 public:
  /// weights: one per point, finite and >= 0; empty for 1. Cost: O(n log n).
  FarthestTree(std::span<const Vec3> points, std::span<const double> weights, const RunContext& context);

  /// Chooses a point and shortens the distances of all others. Cost: about O(log n) on average over a whole ranking.
  void choose(Index point);

  [[nodiscard]] Index farthest() const { return index_[nodes_[0].far.slot]; }                ///< largest d
  [[nodiscard]] double farthest_sq() const { return nodes_[0].far.value; }                   ///< that d
  [[nodiscard]] Index weighted_farthest() const { return index_[nodes_[0].weighted.slot]; }  ///< largest w d
  [[nodiscard]] double weighted_farthest_sq() const { return nodes_[0].weighted.value; }

 private:
  struct Best {
    double value;
    std::uint32_t slot;
  };
  struct Node {
    std::array<double, 3> min, max;
    Best far, weighted;
    std::uint32_t begin, end;
    std::uint32_t right;  // 0 in a leaf; the left child follows its parent
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end, std::span<const Vec3> points, const RunContext& context);
  bool update(std::uint32_t node, const std::array<double, 3>& chosen);
  bool update_leaf(Node& leaf, const std::array<double, 3>& chosen);
  [[nodiscard]] bool better(const Best& a, const Best& b) const {
    return a.value > b.value || (a.value == b.value && index_[a.slot] < index_[b.slot]);
  }

  std::vector<Node> nodes_;
  std::vector<double> x_, y_, z_, weight_, distance_sq_;  // in slot order
  std::vector<Index> index_;                              // slot -> point
  std::vector<std::uint32_t> slot_;                       // point -> slot
};

}  // namespace shapelight
