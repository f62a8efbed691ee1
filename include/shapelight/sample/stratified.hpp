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

/// Parameters of sample_stratified().
struct StratifiedSamplingOptions {
  std::uint64_t seed = 0;    ///< the only source of randomness
  double suppression = 0.5;  ///< [1] smallest distance of two samples, in edges of a stratum

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"seed", "1", "Seed of the random numbers.", 0.0, 0x1.0p64}, o.seed);
    visit(OptionInfo{"stratified-suppression", "stratum edges", "Samples nearer than this to another are dropped.", 0.0,
                     1.0},
          o.suppression);
  }
};

/// Stratified point sampling after Nehab and Shilane, "Stratified point sampling of 3D models" (2004): the surface is
/// cut into strata by a regular grid, and each stratum gives one point, drawn at random with a weight that falls to
/// nothing at the stratum's border; of two samples that still lie too close across a border, the one farther from the
/// centre of its stratum is dropped.
/// target.spacing is the edge of a stratum. For target.count the edge is searched so that there are about as many
/// strata as points, and farthest points replace those that were dropped. Pre:    candidates ascending, unique,
/// vertices of the graph. Post:   exactly target.count vertices, or at most one per stratum; no duplicates. Throws:
/// InvalidInput (also for a spacing below 2^-21 of the extent), Cancelled. Cost:   O(n log n), about 100 n bytes.
[[nodiscard]] std::vector<Index> sample_stratified(const SurfaceGraph& graph, std::span<const Index> candidates,
                                                   const SamplingTarget& target,
                                                   const StratifiedSamplingOptions& options = {},
                                                   const RunContext& context = {});

}  // namespace shapelight
