#pragma once

#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/sample/sampling_target.hpp"

namespace shapelight {

/// sample_covariance() has no parameters.
struct CovarianceSamplingOptions {
  template <class Self, class Visitor>
  static void describe(Self&, Visitor&&) {}
};

/// Geometrically stable sampling after Gelfand, Ikemoto, Rusinkiewicz and Levoy (3DIM 2003): point-to-plane
/// registration sees vertex i as the constraint v_i = (p_i x n_i, n_i), p centred and scaled to unit mean radius.
/// The six eigenvectors of C = sum v v' over all candidates are the motions that the surface resists more or less.
/// Greedily, the motion that the sample resists least so far gets the unused vertex that resists it most, so that all
/// six eigenvalues of the sample's own C grow alike. The order is a ranking. Vertices without a normal resist nothing
/// and come last. Pre:    candidates ascending, unique, vertices of the graph; target is a count. Post:   exactly
/// target.count vertices, no duplicates. Throws: InvalidInput (also when no candidate has a normal), Cancelled. Cost:
/// O(n + count log count) for each of the six motions, 150 n bytes.
[[nodiscard]] std::vector<Index> sample_covariance(const SurfaceGraph& graph, std::span<const Index> candidates,
                                                   const SamplingTarget& target,
                                                   const CovarianceSamplingOptions& options = {},
                                                   const RunContext& context = {});

}  // namespace shapelight
