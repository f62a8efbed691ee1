#pragma once

#include <span>

#include "shapelight/core/run_context.hpp"
#include "simplify/manifold_mesh.hpp"

namespace shapelight::simplification {

struct QuadricCollapse {
  Placement placement = Placement::Input;
  double boundary_weight = 1.0;
  std::span<const float> removal_weight{};  ///< per vertex of the mesh: factor on the cost of removing it; empty: 1
  bool must_reach = true;                   ///< throw TargetUnreachable when stuck; else return what was reached
};

/// Collapses edges, cheapest quadric first, until the target is met (counted as merge_copies() will).
[[nodiscard]] ManifoldMesh collapse_quadrics(ManifoldMesh&& mesh, const SimplifyTarget& target,
                                             const QuadricCollapse& options, const RunContext& context);

}  // namespace shapelight::simplification
