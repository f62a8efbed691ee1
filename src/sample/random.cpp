#include "shapelight/sample/random.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "core/random.hpp"
#include "sample/candidates.hpp"

namespace shapelight {
namespace {

struct KeyedVertex {
  double key;
  Index vertex;
  friend bool operator<(const KeyedVertex& a, const KeyedVertex& b) {
    return a.key < b.key || (a.key == b.key && a.vertex < b.vertex);
  }
};

}  // namespace

std::vector<Index> sample_random(const SurfaceGraph& graph, std::span<const Index> candidates,
                                 const SamplingTarget& target, const RandomSamplingOptions& options,
                                 const RunContext& context) {
  check_sampling(graph, candidates, target);
  require_count(target, "random");
  context.report(0.0, "random sampling");

  std::vector<KeyedVertex> keyed(candidates.size());
  parallel::for_chunks(context, candidates.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index vertex = candidates[i];
      const double u = random01(options.seed, kRandomStream, vertex);
      // 1 - u is never 0; a vertex without area gets an infinite key and comes last.
      keyed[i] = {options.area_weighted ? -std::log(1.0 - u) / graph.area[vertex] : u, vertex};
      if (std::isnan(keyed[i].key)) keyed[i].key = HUGE_VAL;
    }
  });
  const auto end = keyed.begin() + static_cast<std::ptrdiff_t>(target.count);
  if (end != keyed.end()) std::nth_element(keyed.begin(), end, keyed.end());
  std::sort(keyed.begin(), end);

  std::vector<Index> chosen(target.count);
  std::transform(keyed.begin(), end, chosen.begin(), [](const KeyedVertex& k) { return k.vertex; });
  context.report(1.0, "random sampling");
  return chosen;
}

}  // namespace shapelight
