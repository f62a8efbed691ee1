#pragma once

#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/sample/sampling_target.hpp"

namespace shapelight {

/// Parameters of sample_voxel().
struct VoxelSamplingOptions {
  double fill_share = 0.15;  ///< [1] share of an exact count that closes the largest gaps instead of filling a voxel

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"voxel-fill-share", "1", "Share of an exact count that goes to the largest gaps.", 0.0, 1.0},
          o.fill_share);
  }
};

/// One point per occupied cube of a regular grid: the one nearest to the centroid of the cube's points, so always an
/// input point. The centre of the candidates' bounding box is the centre of a cube.
/// With target.spacing that is all: spacing is the edge of a cube. With target.count the edge is searched so that about
/// (1 - fill_share) of the points come from cubes; the others are chosen by farthest point, which makes the
/// count exact and closes the gaps that a grid leaves where the surface cuts corners of cubes.
/// Pre:    candidates ascending, unique, vertices of the graph.
/// Post:   exactly target.count vertices, or one per occupied cube; no duplicates.
/// Throws: InvalidInput (also for a spacing below 2^-21 of the extent), Cancelled.
/// Cost:   O(n log n), about 100 n bytes.
[[nodiscard]] std::vector<Index> sample_voxel(const SurfaceGraph& graph, std::span<const Index> candidates,
                                              const SamplingTarget& target, const VoxelSamplingOptions& options = {},
                                              const RunContext& context = {});

}  // namespace shapelight
