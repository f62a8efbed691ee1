#pragma once

#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/sample/sampling_target.hpp"

namespace shapelight {

/// Parameters of the default sampler.
struct ShapeSamplingOptions {
  double local_weight = 0.65;  ///< [1] T: share of the picks that follow the density; 0 is farthest point sampling

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"local-weight", "1", "Share of points chosen for local detail (the paper's T).", 0, 1},
          o.local_weight);
  }
};

/// Fields of a surface that say where its detail is; each one value per vertex.
struct ShapeFields {
  std::span<const double> curvedness;         ///< [1/length] sqrt((k1^2 + k2^2) / 2)
  std::span<const double> surface_variation;  ///< [1] smallest eigenvalue share of the local covariance
  std::span<const double> shape_index;        ///< [1] in [-1, 1]; may be empty: no modulation
  std::span<const double> reflectance;        ///< [1] |R| <= log 2; may be empty: no modulation
  bool noisy = false;                         ///< the floor of the surface variation is noise: subtract it
};

/// Density of samples that the shape asks for: w = max(0.15, 0.3 N(A) + 0.7 N(B^1.5)), where A is the squared
/// curvedness times (0.5 + |s|)(1 + 4|R|), averaged over the 1-ring, B the surface variation, and N scales to an area
/// mean of 1 with values capped at 6 means. Not-finite field values count as 0. Outliers and isolated vertices get 0.
/// Source: paper, sections II.A-II.B for s and R; the density is ours.
/// Pre: every non-empty field has graph.size() values (InvalidInput). Cost: O(n + m).
[[nodiscard]] std::vector<double> sampling_density(const SurfaceGraph& graph, const ShapeFields& fields,
                                                   const RunContext& context = {});

/// Weighted farthest point sampling, local and global picks by turns: a share T of the picks takes the largest w d^2,
/// the rest the largest d^2, with d the distance to the points already chosen. The result is a ranking: every prefix
/// is a good sample with a share T of local picks (within one). The global picks alone are a greedy k-centre solution,
/// so no gap is wider than twice the optimum for (1 - T) n points. For the first pick d is the distance to the
/// candidates' centroid.
/// With a spacing instead of a count it stops when every candidate is within that distance of a chosen one.
/// Source: paper, eq. 14 for T. Pre: density.size() == graph.size(), finite, >= 0; candidates ascending, unique.
/// Throws InvalidInput, Cancelled. Cost: O(n log n) to build, then about 28 distances per candidate for all of them.
[[nodiscard]] std::vector<Index> sample_by_shape(const SurfaceGraph& graph, std::span<const Index> candidates,
                                                 std::span<const double> density, const SamplingTarget& target,
                                                 const ShapeSamplingOptions& options = {},
                                                 const RunContext& context = {});

/// Farthest point sampling (Eldar et al. 1997), exact: sample_by_shape with T = 0. A ranking. Cost: as above.
[[nodiscard]] std::vector<Index> sample_farthest(const SurfaceGraph& graph, std::span<const Index> candidates,
                                                 const SamplingTarget& target, const RunContext& context = {});

}  // namespace shapelight
