#pragma once

#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Parameters of non_local_means().
struct NonLocalMeansOptions {
  int window_rings = 3;     ///< [rings] where similar patches are looked for
  int max_candidates = 64;  ///< [points] at most so many of them, nearest rings first
  double bandwidth_sq = 0;  ///< [field unit squared] d^2 of eq. 1; 0: twice the median patch distance of neighbours

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"nlm-rings", "rings", "Window in which similar patches are looked for.", 1, 20}, o.window_rings);
    visit(OptionInfo{"nlm-candidates", "points", "Largest number of patches compared with each.", 1, 1000},
          o.max_candidates);
    visit(OptionInfo{"nlm-bandwidth-sq", "field unit squared", "Patch distance that counts as similar; 0: automatic.",
                     0, 1e300},
          o.bandwidth_sq);
  }
};

/// Non-local means of a scalar field (eq. 1 and 3 of the paper): every value becomes a mean over the vertices around,
/// weighted by how alike their surroundings are, so noise goes and edges stay.
///
/// Patch of a vertex: the 4x4 control net of a bicubic B-spline that approximates the field over the 2-ring, projected
/// to the tangent plane and scaled into [0, 1]^2 about the vertex (one level of Lee, Wolberg and Shin, applied to the
/// deviation from the patch's mean, so that adding a constant to the field adds it to the result). Frame: direction1
/// and its perpendicular. Distance of two patches: the least, over four quarter turns, of the mean squared difference
/// with Gaussian weights of one cell. Weight: exp(-distance / d^2), 0 beyond 8 d^2; the vertex itself gets the largest
/// of the others' weights, and 1 when there is none.
/// Pre:   field.size() == direction1.size() == graph.size(); finite; direction1 unit tangents or zero (any frame).
/// Post:  every value lies between the smallest and the largest of its window; finite.
/// Throws InvalidInput (names option or vertex), Cancelled.
/// Cost:  O(n max_candidates); 72 n bytes beyond the result. Support: window_rings + 2 rings.
[[nodiscard]] std::vector<double> non_local_means(const SurfaceGraph& graph, std::span<const double> field,
                                                  std::span<const Vec3> direction1,
                                                  const NonLocalMeansOptions& options = {},
                                                  const RunContext& context = {});

}  // namespace shapelight
