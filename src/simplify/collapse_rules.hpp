#pragma once

#include <limits>
#include <span>
#include <vector>

#include "simplify/collapse_mesh.hpp"
#include "simplify/quadric_collapse.hpp"

namespace shapelight::simplify {

inline constexpr float kNever = std::numeric_limits<float>::infinity();

/// What the two placements have in common: the mesh, and what a removal costs beyond its quadric.
class CollapseRule {
 public:
  CollapseRule(CollapseMesh& mesh, std::span<const float> removal_weight);

 protected:
  // Added per squared length and unit of quadric, so that flat regions, where all errors tie at 0, collapse their short
  // edges first. A plane's error counts for more as soon as it passes a thousandth of the edge.
  static constexpr float kLengthPenalty = 1e-6f;

  /// The cost times the weight of removing u. Infinite weights come after all others, in order of the cost.
  [[nodiscard]] float weighted(float cost, float weight) const;

  CollapseMesh& mesh_;
  std::vector<float> weight_;  // per vertex, or empty
};

/// Placement::Input: u goes into its neighbour v, which stays where it is. Every vertex keeps its own best target.
class InputRule : public CollapseRule {
 public:
  using CollapseRule::CollapseRule;
  [[nodiscard]] float cost(Index u, Index v) const;
  [[nodiscard]] bool is_legal(Index u, Index v, bool slivers) const;
  struct Outcome {
    CollapseMesh::Wing wing;
    Index kept;
    bool gained_own_edges;  ///< the gained neighbours' best may now be an edge to the kept vertex
  };
  Outcome collapse(Index u, Index v);
};

/// Placement::Optimal: u and v go where the sum of their quadrics is least. An edge belongs to the one of its ends that
/// became what it is later; the sum of two quadrics only grows, so that the other end's older keys are lower bounds.
class OptimalRule : public CollapseRule {
 public:
  using CollapseRule::CollapseRule;
  [[nodiscard]] float cost(Index u, Index v) const;
  [[nodiscard]] bool is_legal(Index u, Index v, bool slivers) const;
  InputRule::Outcome collapse(Index u, Index v);

 private:
  struct Merger {
    Index removed, kept;
    Vec3f position;
    float error;
  };
  [[nodiscard]] Merger merge(Index u, Index v) const;
  [[nodiscard]] bool is_allowed(Index u, Index v) const;
  std::uint32_t clock_ = 0;
};

}  // namespace shapelight::simplify
