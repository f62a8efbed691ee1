#pragma once

#include <functional>
#include <span>

#include "simplify/measured_mesh.hpp"

namespace shapelight::simplification {

struct MeasuredCollapse {
  std::span<const float> removal_weight{};  ///< per input vertex: factor on what removing it costs
  /// Called on the targets of a round's collapses, to fit them to their samples; empty: vertices stay where they are.
  std::function<void(std::span<const Index>)> fit{};
  /// Backward error of the faces that removing u into v would leave: guards against folds; empty: no guard.
  std::function<double(Index u, Index v)> backward{};
};

/// Removes vertices, each into a neighbour, the ones whose removal raises the measured energy least first, until
/// done() says so. Works in rounds over independent sets, so the order is nearly greedy, and the same for any number of
/// threads. Returns false when no removal is possible before that.
[[nodiscard]] bool collapse_measured(MeasuredMesh& measured, std::size_t num_to_remove, const MeasuredCollapse& options,
                                     const RunContext& context);

}  // namespace shapelight::simplification
