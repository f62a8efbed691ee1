#pragma once

#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Parameters of smooth_positions().
struct TaubinSmoothingOptions {
  int iterations = 15;     ///< [1] each a step inwards and one back
  double shrink = 0.5;     ///< [1] share of the way to the neighbours' mean
  double inflate = -0.53;  ///< [1] the same, backwards

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"smoothing-iterations", "1", "Steps inwards and back.", 0, 1000}, o.iterations);
    visit(OptionInfo{"smoothing-shrink", "1", "Share of the way to the neighbours' mean.", 0, 1}, o.shrink);
    visit(OptionInfo{"smoothing-inflate", "1", "The same, backwards.", -1, 0}, o.inflate);
  }
};

/// The vertices' positions without noise (Taubin 1995): steps to the mean of the neighbours and back, which take out
/// what changes from vertex to vertex and keep the volume. Border vertices move along the border only; isolated ones
/// stay. Relative to graph.origin, as graph.position. With the defaults, noise of independent vertices falls to about
/// a fifth, and a sphere keeps its radius within 1 % from ten edges per radius on.
/// Throws InvalidInput (option out of range), Cancelled. Cost: O(iterations (n + m)).
[[nodiscard]] std::vector<Vec3> smooth_positions(const SurfaceGraph& graph, const TaubinSmoothingOptions& options = {},
                                                 const RunContext& context = {});

}  // namespace shapelight
