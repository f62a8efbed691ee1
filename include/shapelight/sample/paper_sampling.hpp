#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/sample/sampling_target.hpp"

namespace shapelight {

/// Parameters of the paper's sampler.
struct PaperSamplingOptions {
  double local_weight = 0.65;  ///< [1] T of eq. 14: share of local points
  double voxel_size = 0.0;     ///< [input length unit] 0: sqrt(1.5 area / number of global points)

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"local-weight", "1", "Share of points chosen for local detail (the paper's T).", 0, 1},
          o.local_weight);
    visit(OptionInfo{"voxel-size", "input length units",
                     "Voxels of the paper's global sampling; 0: from area and count.", 0, 1e300},
          o.voxel_size);
  }
};

/// The paper's sampling, as literally as it can be read (section II.D, eq. 13, 14): round(T n) local points, then
/// global ones from those not yet chosen, exactly target.count in all.
///
/// - Local: every segment gets a quota by its size (largest remainder) and gives the points with the largest |s|.
/// - Global: voxels over the bounding box; H = entropy of a histogram of s over the voxel's points in 32 bins (eq. 13
///   with one probability per vertex, as printed, is always log2 of their number); quota in proportion to 1 + H; in
///   each voxel first the point nearest to the centroid, then the farthest from those chosen; no two chosen points of
///   adjacent voxels closer than half sqrt(area / n_G), a distance that is relaxed by 0.7 until all quotas are filled.
///
/// Local points first in the result. It covers features worse than farthest points do at 2 to 5 %, which the
/// documentation shows; sample_by_shape() is the better way.
/// Pre: shape_index and segment have graph.size() values; candidates ascending, unique; target is a count.
/// Throws InvalidInput, Cancelled. Cost: O(n log n).
[[nodiscard]] std::vector<Index> sample_paper(const SurfaceGraph& graph, std::span<const Index> candidates,
                                              std::span<const double> shape_index,
                                              std::span<const std::uint32_t> segment, const SamplingTarget& target,
                                              const PaperSamplingOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
