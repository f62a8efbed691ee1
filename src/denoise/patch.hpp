#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// The 4x4 B-spline control net of a vertex's surroundings (eq. 3). Values are scaled by the square roots of the
/// Gaussian weights, which sum to 1, so that a weighted mean squared difference is a plain squared distance.
/// One cache line.
struct alignas(64) PatchNet {
  std::array<float, 16> value{};  ///< row-major
};

/// The four quarter turns of one net, side by side: lane r of element m belongs to turn r.
using TurnedNet = std::array<Eigen::Array4f, 16>;

/// Nets of all vertices and the Gaussian-weighted mean of each, which no quarter turn changes.
struct PatchNets {
  std::vector<PatchNet> net;
  std::vector<float> mean;
};

[[nodiscard]] PatchNets build_patch_nets(const SurfaceGraph& graph, std::span<const double> field,
                                         std::span<const Vec3> direction1, const RunContext& context);

/// The Gaussian weights of the squared differences are themselves unchanged by quarter turns.
[[nodiscard]] TurnedNet turned_net(const PatchNet& net);

/// Least weighted mean squared difference over the four turns. All turns at once, lane by lane: no sums across lanes.
[[nodiscard]] inline float patch_distance(const TurnedNet& turned, const PatchNet& net) {
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (std::size_t m = 0; m < 16; ++m) sum += (turned[m] - net.value[m]).square();
  return sum.minCoeff();
}

}  // namespace shapelight
