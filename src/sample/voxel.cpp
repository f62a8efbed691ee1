#include "shapelight/sample/voxel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "sample/candidates.hpp"
#include "sample/cell_grid.hpp"
#include "sample/spread.hpp"

namespace shapelight {
namespace {

// Two points are equally far from their centroid; rounding must not choose between them, or units would matter.
constexpr double kTie = 1.0 - 1e-9;

/// The point of every cell that is nearest to the centroid of the cell's points; the first one of several.
std::vector<Index> nearest_to_centroids(const CellGrid& grid, const RunContext& context) {
  std::vector<Index> chosen(grid.num_cells());
  parallel::for_chunks(context, grid.num_cells(), [&](std::size_t cells_begin, std::size_t cells_end) {
    for (std::size_t cell = cells_begin; cell < cells_end; ++cell) {
      const auto [begin, end] = grid.slots_of_cell(cell);
      // Relative to the first point, so that a far origin costs no digits.
      Vec3 offset = Vec3::Zero();
      for (std::uint32_t slot = begin; slot < end; ++slot) offset += grid.point(slot) - grid.point(begin);
      const Vec3 centroid = grid.point(begin) + offset / (end - begin);
      double best = std::numeric_limits<double>::infinity();
      for (std::uint32_t slot = begin; slot < end; ++slot) {
        const double distance_sq = (grid.point(slot) - centroid).squaredNorm();
        if (distance_sq < kTie * best) {
          best = distance_sq;
          chosen[cell] = grid.index(slot);
        }
      }
    }
  });
  return chosen;
}

}  // namespace

std::vector<Index> sample_voxel(const SurfaceGraph& graph, std::span<const Index> candidates,
                                const SamplingTarget& target, const VoxelSamplingOptions& options,
                                const RunContext& context) {
  validate_options(options);
  check_sampling(graph, candidates, target);
  context.report(0.0, "voxel sampling");
  const std::vector<Vec3> points = gather_positions(graph, candidates);

  double cell = target.spacing;
  if (target.count > 0) {
    const double share = (1.0 - options.fill_share) * static_cast<double>(target.count);
    cell = find_cell_size(points, std::max<std::size_t>(1, static_cast<std::size_t>(share)), context);
  }
  check_cell_size(points, cell, "voxel");
  std::vector<Index> chosen = nearest_to_centroids(CellGrid(points, cell, context), context);
  context.report(0.5, "voxel sampling");
  fill_farthest(points, target.count, std::sqrt(3.0) * cell, chosen, context);
  to_vertices(candidates, chosen);
  context.report(1.0, "voxel sampling");
  return chosen;
}

}  // namespace shapelight
