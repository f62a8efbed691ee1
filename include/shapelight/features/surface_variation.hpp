#pragma once

#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Parameters of compute_surface_variation().
struct SurfaceVariationOptions {
  int neighbors = 30;  ///< [points] size of the neighbourhood that is imitated

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"variation-neighbors", "points", "Neighbourhood of the surface variation.", 6, 1000}, o.neighbors);
  }
};

/// Surface variation l0 / (l0 + l1 + l2) per vertex (Pauly), l0 <= l1 <= l2 being the eigenvalues of the covariance of
/// the points around it: 0 on a plane, at most 1/3.
///
/// No neighbour is searched for: the first and second moments of the positions are averaged over the 1-ring a few
/// times, which weighs the points around a vertex by a bell of the same width as the disk of its nearest `neighbors`
/// points. The number of passes, neighbors / (mean degree + 1), is 4 on meshes and 2 on 12-nearest-neighbour clouds.
/// Pre:   as SurfaceGraph promises.
/// Post:  values in [0, 1/3]; 0 for an isolated vertex; unchanged by rigid motion and scale.
/// Throws InvalidInput (option out of range), Cancelled.
/// Cost:  O(passes x edges); 144 n bytes beyond the result. Support: `passes` rings.
[[nodiscard]] std::vector<double> compute_surface_variation(const SurfaceGraph& graph,
                                                            const SurfaceVariationOptions& options = {},
                                                            const RunContext& context = {});

}  // namespace shapelight
