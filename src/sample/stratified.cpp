#include "shapelight/sample/stratified.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.hpp"
#include "core/random.hpp"
#include "sample/candidates.hpp"
#include "sample/cell_grid.hpp"
#include "sample/spread.hpp"

namespace shapelight {
namespace {

/// The points drawn, one per stratum, and how far inside its stratum each lies: 1 in the centre, 0 on the border.
struct Strata {
  std::vector<Index> point;
  std::vector<double> depth;
};

/// A product of tents over the unit cube, kept above 0 so that a stratum with border points only still gives one.
double depth_in_cell(const Vec3& within) {
  const Vec3 tent = Vec3::Ones() - (2.0 * within - Vec3::Ones()).cwiseAbs();
  return std::max(1e-9, tent.prod());
}

Strata draw_from_strata(const CellGrid& grid, std::span<const Index> candidates, std::uint64_t seed,
                        const RunContext& context) {
  Strata strata{std::vector<Index>(grid.num_cells()), std::vector<double>(grid.num_cells())};
  parallel::for_chunks(context, grid.num_cells(), [&](std::size_t cells_begin, std::size_t cells_end) {
    for (std::size_t cell = cells_begin; cell < cells_end; ++cell) {
      const auto [begin, end] = grid.slots_of_cell(cell);
      double best = HUGE_VAL;
      for (std::uint32_t slot = begin; slot < end; ++slot) {
        const double depth = depth_in_cell(grid.lattice().within(grid.point(slot)));
        const double u = random01(seed, kStratifiedStream, candidates[grid.index(slot)]);
        const double key = -std::log(1.0 - u) / depth;  // the smallest is drawn in proportion to depth
        if (key < best) {
          best = key;
          strata.point[cell] = grid.index(slot);
          strata.depth[cell] = depth;
        }
      }
    }
  });
  return strata;
}

/// Of points nearer to each other than `distance`, the deepest in its stratum stays.
std::vector<Index> suppress_close(const Strata& strata, std::span<const Vec3> points, double distance,
                                  const RunContext& context) {
  std::vector<Vec3> drawn;
  for (const Index i : strata.point) drawn.push_back(points[i]);
  const CellGrid grid(drawn, std::max(distance, Lattice::min_cell(bounding_box(drawn))), context);
  std::vector<std::uint32_t> order(drawn.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double depth_a = strata.depth[grid.index(a)];
    const double depth_b = strata.depth[grid.index(b)];
    return depth_a > depth_b || (depth_a == depth_b && a < b);
  });
  std::vector<Index> kept = throw_darts(grid, order, distance, drawn.size(), context);
  for (Index& slot : kept) slot = strata.point[grid.index(slot)];
  return kept;
}

}  // namespace

std::vector<Index> sample_stratified(const SurfaceGraph& graph, std::span<const Index> candidates,
                                     const SamplingTarget& target, const StratifiedSamplingOptions& options,
                                     const RunContext& context) {
  validate_options(options);
  check_sampling(graph, candidates, target);
  context.report(0.0, "stratified sampling");
  const std::vector<Vec3> points = gather_positions(graph, candidates);

  const double cell = target.count > 0 ? find_cell_size(points, target.count, context) : target.spacing;
  check_cell_size(points, cell, "stratified");
  const Strata strata = draw_from_strata(CellGrid(points, cell, context), candidates, options.seed, context);
  std::vector<Index> chosen = suppress_close(strata, points, options.suppression * cell, context);
  context.report(0.5, "stratified sampling");
  fill_farthest(points, target.count, std::sqrt(3.0) * cell, chosen, context);
  to_vertices(candidates, chosen);
  context.report(1.0, "stratified sampling");
  return chosen;
}

}  // namespace shapelight
