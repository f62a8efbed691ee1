#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/sample/sampling_target.hpp"

namespace shapelight {

/// Parameters of sample_normal_space().
struct NormalSpaceSamplingOptions {
  std::uint64_t seed = 0;  ///< the only source of randomness
  int collars = 9;         ///< [rings of cells] from pole to pole of the sphere of normals; 9 make 82 cells

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"seed", "1", "Seed of the random numbers.", 0.0, 0x1.0p64}, o.seed);
    visit(OptionInfo{"normal-collars", "rings of cells", "Rings that cut the sphere of normals from pole to pole.", 2.0,
                     200.0},
          o.collars);
  }
};

/// Normal-space sampling after Rusinkiewicz and Levoy, "Efficient variants of the ICP algorithm" (2001), section 3.1:
/// the normals are sorted into cells of the sphere, and points are drawn at random, evenly over the cells. So a
/// small groove in a plane gets as many samples as the plane itself. The cells have equal area; one is centred on each
/// axis if the number of collars is odd, so that noise does not scatter an axis-aligned plane over many cells.
/// Cells are drawn by turns, in random order within a turn, until empty. The order is a ranking.
/// Vertices without a normal come last.
/// Pre:    candidates ascending, unique, vertices of the graph; target is a count.
/// Post:   exactly target.count vertices, no duplicates; two cells differ by at most one unless the smaller is used up.
/// Throws: InvalidInput (also when no candidate has a normal), Cancelled.
/// Cost:   O(n log n), 40 n bytes.
[[nodiscard]] std::vector<Index> sample_normal_space(const SurfaceGraph& graph, std::span<const Index> candidates,
                                                     const SamplingTarget& target,
                                                     const NormalSpaceSamplingOptions& options = {},
                                                     const RunContext& context = {});

}  // namespace shapelight
