#include "shapelight/sample/poisson.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/random.hpp"
#include "sample/candidates.hpp"
#include "sample/cell_grid.hpp"
#include "sample/spread.hpp"

namespace shapelight {
namespace {

/// Throws darts of changing radius over the same points in the same random order.
class DartBoard {
 public:
  DartBoard(std::span<const Vec3> points, std::span<const Index> candidates, std::uint64_t seed)
      : points_(points), order_of_index_(points.size()) {
    std::vector<std::pair<std::uint64_t, Index>> keyed(points.size());
    for (Index i = 0; i < points.size(); ++i) keyed[i] = {random_bits(seed, kPoissonStream, candidates[i]), i};
    std::sort(keyed.begin(), keyed.end());
    std::transform(keyed.begin(), keyed.end(), order_of_index_.begin(), [](const auto& k) { return k.second; });
  }

  /// Indices of the points taken; stops after `limit`.
  std::vector<Index> throw_at(double radius, std::size_t limit, const RunContext& context) {
    // A cell much larger than the radius holds too many points, a smaller one cannot vouch for it.
    if (!grid_ || radius > grid_->cell() || radius < 0.4 * grid_->cell()) build_grid(1.1 * radius, context);
    std::vector<Index> taken = throw_darts(*grid_, order_, radius, limit, context);
    for (Index& slot : taken) slot = grid_->index(slot);
    return taken;
  }

 private:
  void build_grid(double cell, const RunContext& context) {
    grid_.emplace(points_, std::max(cell, Lattice::min_cell(bounding_box(points_))), context);
    const std::vector<std::uint32_t> slot_of_index = grid_->slot_of_index();
    order_.resize(points_.size());
    std::transform(order_of_index_.begin(), order_of_index_.end(), order_.begin(),
                   [&](Index i) { return slot_of_index[i]; });
  }

  std::span<const Vec3> points_;
  std::vector<Index> order_of_index_;
  std::vector<std::uint32_t> order_;  // the same order, in slots of the grid
  std::optional<CellGrid> grid_;
};

struct DiskSet {
  double radius = 0.0;
  std::vector<Index> taken;
};

/// The largest maximal set of at most `count` points that `passes` tries find. Counts fall with the radius only on the
/// average, so tries near the right radius differ by a few points, and one of them soon meets the count.
DiskSet find_disks(DartBoard& board, double radius, std::size_t count, int passes, const RunContext& context) {
  DiskSet best;
  double too_many = 0.0;  // largest radius seen with more than `count` points
  double few_enough = HUGE_VAL;
  for (int pass = 0; best.taken.empty() || (pass < passes && best.taken.size() < count); ++pass) {
    std::vector<Index> taken = board.throw_at(radius, 2 * count, context);
    const std::size_t size = taken.size();
    if (size > count) {
      too_many = std::max(too_many, radius);
    } else {
      few_enough = std::min(few_enough, radius);
      if (size > best.taken.size()) best = {radius, std::move(taken)};
    }
    context.report(0.9 * (pass + 1.0) / (pass + 3.0), "Poisson disk sampling");
    // Number of disks ~ radius^-2 on a surface; halve the bracket when that leads out of it.
    radius *= std::sqrt(static_cast<double>(size) / (static_cast<double>(count)));
    if (!(radius > too_many && radius < few_enough)) {
      radius = std::isinf(few_enough) ? 1.5 * too_many : 0.5 * (too_many + few_enough);
    }
  }
  return best;
}

}  // namespace

std::vector<Index> sample_poisson(const SurfaceGraph& graph, std::span<const Index> candidates,
                                  const SamplingTarget& target, const PoissonSamplingOptions& options,
                                  const RunContext& context) {
  validate_options(options);
  check_sampling(graph, candidates, target);
  context.report(0.0, "Poisson disk sampling");
  const std::vector<Vec3> points = gather_positions(graph, candidates);
  DartBoard board(points, candidates, options.seed);

  std::vector<Index> chosen;
  if (target.count > 0) {
    // A surface of area A meets about 1.5 A / c^2 cells of size c and holds about 0.7 A / r^2 random disks of radius r.
    const double radius = 0.68 * find_cell_size(points, target.count, context);
    DiskSet disks = find_disks(board, radius, target.count, options.passes, context);
    chosen = std::move(disks.taken);
    fill_farthest(points, target.count, disks.radius, chosen, context);
  } else {
    chosen = board.throw_at(target.spacing, points.size(), context);
  }
  to_vertices(candidates, chosen);
  context.report(1.0, "Poisson disk sampling");
  return chosen;
}

}  // namespace shapelight
