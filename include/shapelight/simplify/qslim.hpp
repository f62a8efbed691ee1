#pragma once

#include <span>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"

namespace shapelight {

struct QslimOptions {
  Placement placement = Placement::Input;
  double boundary_weight = 1.0;  ///< [1] of the planes that stand on borders and feature edges

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"placement", "", "Where vertices may lie.", 0, 0}, o.placement);
    visit(OptionInfo{"boundary-weight", "1", "Weight of the planes that hold borders in place.", 0, 1e9},
          o.boundary_weight);
  }
};

/// Quadric edge collapse (Garland and Heckbert 1997): the baseline of the paper, section III.A, and a product in its own
/// right. Area-weighted plane quadrics; the edge of least error is collapsed into one of its ends (Placement::Input)
/// or into the point of least error; link condition, no face turns over, no sliver is made.
/// Throws InvalidInput (an index out of range, a non-finite vertex in use, not exactly one target), TargetUnreachable
/// (topology allows no further collapse; says how far it got), Cancelled. Same result for any RunContext.
/// Cost: about 1 us (Input) or 2 us (Optimal) and 300 or 380 bytes per input vertex.
[[nodiscard]] SimplifiedMesh simplify_qslim(const TriangleMesh& mesh, const SimplifyTarget& target,
                                            const QslimOptions& options = {}, const FeatureEdges& features = {},
                                            const RunContext& context = {}, MeshOddities* oddities = nullptr);

}  // namespace shapelight
