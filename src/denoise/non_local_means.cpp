#include "shapelight/denoise/non_local_means.hpp"

#include <algorithm>
#include <limits>

#include "core/exponential.hpp"
#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "denoise/patch.hpp"
#include "graph/field_checks.hpp"
#include "graph/ring_chunk.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kMostProbes = 16384;  // vertices that decide the automatic bandwidth
constexpr float kCutoff = 8.0f;             // weights below exp(-8) count as 0

// Twice the median distance of the patches of neighbours.
float automatic_bandwidth_sq(const SurfaceGraph& graph, const PatchNets& nets) {
  const std::size_t stride = graph.size() / kMostProbes + 1;
  std::vector<float> distances;
  for (std::size_t i = 0; i < graph.size(); i += stride) {
    const TurnedNet turned = turned_net(nets.net[i]);
    for (const Index j : graph.neighbors_of(i)) distances.push_back(patch_distance(turned, nets.net[j]));
  }
  return 2.0f * median(std::move(distances));
}

// Weighted mean (eq. 1) over candidates; the first is the vertex itself.
double filtered_value(std::span<const double> field, const PatchNets& nets, std::span<const Index> candidates,
                      float bandwidth_sq) {
  const Index center = candidates.front();
  const TurnedNet turned = turned_net(nets.net[center]);
  const float limit = kCutoff * bandwidth_sq;
  double sum = 0.0, total = 0.0;
  float largest = 0.0f;
  for (const Index j : candidates.subspan(1)) {
    // With weights g that sum to 1, (sum g a - sum g b)^2 <= sum g (a - b)^2 by Cauchy and Schwarz, and quarter turns
    // do not change the means: no turn can bring a patch below the squared difference of the means.
    const float apart = nets.mean[center] - nets.mean[j];
    if (apart * apart > limit) continue;
    const float distance = patch_distance(turned, nets.net[j]);
    if (distance > limit) continue;
    const float weight = exp_minus(distance / bandwidth_sq);
    largest = std::max(largest, weight);
    sum += static_cast<double>(weight) * field[j];
    total += static_cast<double>(weight);
  }
  if (largest == 0.0f) return field[center];
  return (sum + static_cast<double>(largest) * field[center]) / (total + static_cast<double>(largest));
}

}  // namespace

std::vector<double> non_local_means(const SurfaceGraph& graph, std::span<const double> field,
                                    std::span<const Vec3> direction1, const NonLocalMeansOptions& options,
                                    const RunContext& context) {
  validate_options(options);
  check_field(graph, field, "field", -1e15, 1e15);
  check_size(graph, direction1.size(), "direction1");

  const PatchNets nets = build_patch_nets(graph, field, direction1, context);
  const float wanted =
      options.bandwidth_sq > 0.0 ? static_cast<float>(options.bandwidth_sq) : automatic_bandwidth_sq(graph, nets);
  // Equal patches everywhere: any positive width gives them the weight 1.
  const float bandwidth_sq = std::max(wanted, std::numeric_limits<float>::min());

  std::vector<double> result(graph.size());
  parallel::for_chunks(
      context, graph.size(),
      [&](std::size_t begin, std::size_t end) {
        RingCollector rings(graph);
        for (std::size_t i = begin; i < end; ++i) {
          const auto candidates = rings.collect(static_cast<Index>(i), options.window_rings,
                                                static_cast<std::size_t>(options.max_candidates) + 1);
          result[i] = filtered_value(field, nets, candidates, bandwidth_sq);
        }
      },
      ring_chunk(graph));
  return result;
}

}  // namespace shapelight
