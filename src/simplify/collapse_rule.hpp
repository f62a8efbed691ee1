#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "simplify/collapse_mesh.hpp"
#include "simplify/quadric_collapse.hpp"

namespace shapelight::simplification {

inline constexpr float kNever = std::numeric_limits<float>::infinity();

/// What the two placements have in common: the mesh, and what a removal costs beyond its quadric.
template <class Scalar>
class CollapseRule {
 public:
  using Mesh = CollapseMesh<Scalar>;

  CollapseRule(Mesh& mesh, std::span<const float> removal_weight) : mesh_(mesh) {
    if (removal_weight.empty()) return;
    weight_.resize(mesh.size());
    for (Index v = 0; v < mesh.size(); ++v) weight_[v] = removal_weight[mesh.original(v)];
  }

  struct Outcome {
    typename Mesh::Wing wing;
    Index kept;
    bool gained_own_edges;  ///< the gained neighbours' best may now be an edge to the kept vertex
  };

 protected:
  // Added per squared length and unit of quadric, so that flat regions, where all errors tie at 0, collapse their short
  // edges first. Above the noise of the scalar: a plane's error counts for more once it passes a ten-thousandth of
  // the edge in single precision, a third of a millionth in double.
  static constexpr Scalar kLengthPenalty = std::is_same_v<Scalar, float> ? Scalar(1e-8) : Scalar(1e-12);

  /// The cost times the weight of removing u. Infinite weights come after all others, in order of the cost.
  [[nodiscard]] static float weighted(float cost, float weight) {
    // Costs lie between the square of single precision and the largest boundary weight, far from either end of float.
    constexpr float kLeast = 1e-20f, kMost = 1e8f, kLast = 1e30f;
    return std::isinf(weight) ? std::clamp(cost, kLeast, kMost) * kLast : std::min(cost * weight, kMost);
  }

  Mesh& mesh_;
  std::vector<float> weight_;  // per vertex, or empty
};

/// The two placements; collapse_quadrics() chooses.
[[nodiscard]] ManifoldMesh collapse_into_input(ManifoldMesh&& mesh, const SimplifyTarget& target,
                                               const QuadricCollapse& options, const RunContext& context);
[[nodiscard]] ManifoldMesh collapse_into_optimum(ManifoldMesh&& mesh, const SimplifyTarget& target,
                                                 const QuadricCollapse& options, const RunContext& context);

}  // namespace shapelight::simplification
