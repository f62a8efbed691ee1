#include "shapelight/denoise/taubin_smoothing.hpp"

#include "core/parallel.hpp"

namespace shapelight {
namespace {

// One step of all vertices, each a share of the way to the mean of its neighbours; of a border vertex, to the mean of
// those on the border.
void step(const SurfaceGraph& graph, double share, const std::vector<Vec3>& from, std::vector<Vec3>& to,
          const RunContext& context) {
  parallel::for_chunks(context, graph.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 sum = Vec3::Zero();
      std::size_t count = 0;
      for (const Index j : graph.neighbors_of(i)) {
        if (graph.boundary[i] && !graph.boundary[j]) continue;
        sum += from[j];
        ++count;
      }
      to[i] = count == 0 ? from[i] : Vec3(from[i] + share * (sum / static_cast<double>(count) - from[i]));
    }
  });
}

}  // namespace

std::vector<Vec3> smooth_positions(const SurfaceGraph& graph, const TaubinSmoothingOptions& options,
                                   const RunContext& context) {
  validate_options(options);
  std::vector<Vec3> positions = graph.position;
  std::vector<Vec3> moved(positions.size());
  for (int i = 0; i < options.iterations; ++i) {
    step(graph, options.shrink, positions, moved, context);
    step(graph, options.inflate, moved, positions, context);
    context.report((i + 1.0) / options.iterations);
  }
  return positions;
}

}  // namespace shapelight
