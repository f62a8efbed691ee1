#include "shapelight/sample/sampling_target.hpp"

#include <fmt/format.h>

#include <cmath>

#include "sample/candidates.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {

void validate(const SamplingTarget& target, std::size_t num_candidates) {
  if (!(target.spacing >= 0.0) || std::isinf(target.spacing)) {
    throw InvalidInput(fmt::format("sampling target: spacing {:g}, expected a finite length above 0", target.spacing));
  }
  if ((target.count > 0) == (target.spacing > 0.0)) {
    throw InvalidInput(fmt::format("sampling target: count {} and spacing {:g}, expected exactly one above 0",
                                   target.count, target.spacing));
  }
  if (target.count > num_candidates) {
    throw InvalidInput(fmt::format("sampling target: count {}, expected at most {}, the points there are", target.count,
                                   num_candidates));
  }
}

void check_sampling(const SurfaceGraph& graph, std::span<const Index> candidates, const SamplingTarget& target) {
  validate(target, candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i] >= graph.size() || (i > 0 && candidates[i] <= candidates[i - 1])) {
      throw InvalidInput(fmt::format("sampling candidates: entry {} is vertex {}, expected ascending vertices below {}",
                                     i, candidates[i], graph.size()));
    }
  }
}

void require_count(const SamplingTarget& target, std::string_view method) {
  if (target.count == 0) {
    throw InvalidInput(
        fmt::format("sampling method {}: spacing {:g}, expected a count or a ratio", method, target.spacing));
  }
}

std::vector<Vec3> gather_positions(const SurfaceGraph& graph, std::span<const Index> candidates) {
  std::vector<Vec3> positions;
  positions.reserve(candidates.size());
  for (const Index vertex : candidates) positions.push_back(graph.position[vertex]);
  return positions;
}

void to_vertices(std::span<const Index> candidates, std::vector<Index>& slots) {
  for (Index& slot : slots) slot = candidates[slot];
}

}  // namespace shapelight
