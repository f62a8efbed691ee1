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

/// Parameters of sample_poisson().
struct PoissonSamplingOptions {
  std::uint64_t seed = 0;  ///< the only source of randomness
  int passes = 6;          ///< [passes] tries to find the radius of an exact count

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"seed", "1", "Seed of the random numbers.", 0.0, 0x1.0p64}, o.seed);
    visit(OptionInfo{"poisson-passes", "passes", "Tries to find the radius that gives the count.", 1.0, 1000.0},
          o.passes);
  }
};

/// Poisson disk sample by dart throwing (Cook 1986) over the candidates in random order: a vertex is taken when no
/// chosen one is nearer than the radius. Every vertex is tried, so the set is maximal: no vertex is farther than the
/// radius from a chosen one.
/// target.spacing is the radius. For target.count the radius is searched until the count is met from below within
/// `passes`; the few points that are still missing are farthest points, so nothing is ever cut off. Nearly all
/// pairs then keep the radius, and the others lie just below it.
/// Pre:    candidates ascending, unique, vertices of the graph.
/// Post:   exactly target.count vertices, or a maximal set whose pairs are at least target.spacing apart; no
/// duplicates. Throws: InvalidInput, Cancelled. Cost:   O(n log n) once and O(n) per pass, about 120 n bytes.
[[nodiscard]] std::vector<Index> sample_poisson(const SurfaceGraph& graph, std::span<const Index> candidates,
                                                const SamplingTarget& target,
                                                const PoissonSamplingOptions& options = {},
                                                const RunContext& context = {});

}  // namespace shapelight
