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

/// Parameters of sample_random().
struct RandomSamplingOptions {
  std::uint64_t seed = 0;      ///< the only source of randomness
  bool area_weighted = false;  ///< draw in proportion to the area that a vertex stands for

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"seed", "1", "Seed of the random numbers.", 0.0, 0x1.0p64}, o.seed);
    visit(OptionInfo{"random-area-weighted", "1", "Draw in proportion to the surface area of a point."},
          o.area_weighted);
  }
};

/// Uniform sample without replacement: the `count` smallest of one hashed key per vertex. With area weights the keys
/// are those of Efraimidis and Spirakis ("Weighted random sampling with a reservoir", 2006): -log(u) / area.
/// The order is a ranking: the sample of n points is a prefix of every larger one.
/// Pre:    candidates ascending, unique, vertices of the graph; target is a count.
/// Post:   exactly target.count vertices, no duplicates.
/// Throws: InvalidInput, Cancelled.
/// Cost:   O(n) and sorting the result; 16 n bytes.
[[nodiscard]] std::vector<Index> sample_random(const SurfaceGraph& graph, std::span<const Index> candidates,
                                               const SamplingTarget& target, const RandomSamplingOptions& options = {},
                                               const RunContext& context = {});

}  // namespace shapelight
