#pragma once

#include <span>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"

namespace shapelight {

struct SsimOptions {
  Placement placement = Placement::Input;
  double sample_weight = 1.5;    ///< [1] factor on the cost of removing a sample
  double boundary_weight = 1.0;  ///< [1] of border error against surface error
  double normal_weight = 0.1;    ///< [1] lambda: error of normals in units of the output's edge length
  double pre_collapse = 3.0;     ///< [1] the quadrics collapse to this multiple of the target, the measured error on;
                                 ///<     1: no measured collapse
  std::uint32_t sweeps = 4;      ///< [rounds] of flips and vertex moves at the end

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"placement", "", "Where vertices may lie.", 0, 0}, o.placement);
    visit(OptionInfo{"sample-weight", "1", "Factor on the cost of removing a sample.", 1, 1e6}, o.sample_weight);
    visit(OptionInfo{"boundary-weight", "1", "Weight of the error of borders.", 0, 1e9}, o.boundary_weight);
    visit(OptionInfo{"normal-weight", "1", "Weight of the error of normals.", 0, 10}, o.normal_weight);
    visit(OptionInfo{"pre-collapse", "1", "Quadrics collapse to this multiple of the target; 1: all the way.", 1, 100},
          o.pre_collapse);
    visit(OptionInfo{"sweeps", "rounds", "Rounds of edge flips and vertex moves at the end.", 0, 100}, o.sweeps);
  }
};

/// What SSim takes beside the mesh; every member may be empty.
struct SsimGuide {
  std::span<const Index> samples;          ///< vertices that carry the shape: a soft prior
  std::span<const Vec3> denoised;          ///< per vertex: the surface that the error is measured against under noise
};

/// SSim (section III.A), by measured error: samples of the input surface stay attached to the simplified one, and
/// collapses, flips and moves are judged by what they do to the distances and normals measured there.
/// Throws InvalidInput, TargetUnreachable, Cancelled as simplify_qslim(). Same result for any RunContext.
/// Cost: 20 to 40 us and 650 bytes per input vertex, more the more vertices are kept; docs/ssim.md has the steps.
[[nodiscard]] SimplifiedMesh simplify_ssim(const TriangleMesh& mesh, const SimplifyTarget& target,
                                           const SsimGuide& guide, const SsimOptions& options = {},
                                           const FeatureEdges& features = {}, const RunContext& context = {},
                                           MeshOddities* oddities = nullptr);

/// SSim as the paper words it: every vertex that is not a sample is collapsed into a neighbour, cheapest quadric first.
/// Where the link condition keeps a vertex, the cheapest sample goes instead, so the count is exact.
[[nodiscard]] SimplifiedMesh simplify_ssim_paper(const TriangleMesh& mesh, const SimplifyTarget& target,
                                                 std::span<const Index> samples, const FeatureEdges& features = {},
                                                 const RunContext& context = {}, MeshOddities* oddities = nullptr);

}  // namespace shapelight
