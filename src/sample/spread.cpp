#include "sample/spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "core/random.hpp"
#include "sample/candidates.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight {
namespace {

/// Distances to the chosen points and the farthest point among the rest.
class FarthestQueue {
 public:
  FarthestQueue(std::span<const Vec3> points, double cell, std::span<const Index> chosen, const RunContext& context);

  Index take();  // the farthest point, which becomes a chosen one

 private:
  struct Entry {
    double distance_sq;
    std::uint32_t tie;
    std::uint32_t slot;
    friend bool operator<(const Entry& a, const Entry& b) {
      if (a.distance_sq != b.distance_sq) return a.distance_sq < b.distance_sq;
      return a.tie != b.tie ? a.tie < b.tie : a.slot > b.slot;
    }
  };
  void approach(std::uint32_t slot);  // lowers the distances around a chosen point
  void measure_far_points(std::span<const Index> chosen, const RunContext& context);

  std::span<const Vec3> points_;
  CellGrid grid_;
  std::vector<std::uint32_t> slot_of_index_;
  std::vector<double> distance_sq_;  // by slot; -1 for a chosen point
  std::vector<Entry> heap_;          // keys may be out of date, never too small
  std::optional<KdTree> tree_;       // for gaps wider than a cell; built when one is met
};

FarthestQueue::FarthestQueue(std::span<const Vec3> points, double cell, std::span<const Index> chosen,
                             const RunContext& context)
    : points_(points),
      grid_(points, cell, context),
      slot_of_index_(grid_.slot_of_index()),
      distance_sq_(points.size(), std::numeric_limits<double>::infinity()) {
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    poll(context, k);
    const std::uint32_t slot = slot_of_index_[chosen[k]];
    grid_.for_each_near(slot, [&](std::uint32_t other) {
      distance_sq_[other] = std::min(distance_sq_[other], (grid_.point(other) - grid_.point(slot)).squaredNorm());
    });
  }
  measure_far_points(chosen, context);
  for (const Index i : chosen) distance_sq_[slot_of_index_[i]] = -1.0;
  heap_.reserve(points.size());
  for (std::uint32_t slot = 0; slot < points.size(); ++slot) {
    poll(context, slot);
    if (distance_sq_[slot] < 0.0) continue;
    const auto tie = static_cast<std::uint32_t>(random_bits(0, kFillStream, grid_.index(slot)));
    heap_.push_back({distance_sq_[slot], tie, slot});
  }
  std::make_heap(heap_.begin(), heap_.end());
}

// Cells vouch only for distances up to their own size; what they say beyond is an upper bound.
void FarthestQueue::measure_far_points(std::span<const Index> chosen, const RunContext& context) {
  const double trusted_sq = grid_.cell() * grid_.cell();
  std::vector<std::uint32_t> far;
  for (std::uint32_t slot = 0; slot < grid_.size(); ++slot) {
    if (distance_sq_[slot] > trusted_sq) far.push_back(slot);
  }
  if (far.empty()) return;
  std::vector<Vec3> positions;
  for (const Index i : chosen) positions.push_back(points_[i]);
  const KdTree tree(positions, context);
  parallel::for_chunks(context, far.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) distance_sq_[far[k]] = tree.nearest(grid_.point(far[k])).distance_sq;
  });
}

void FarthestQueue::approach(std::uint32_t slot) {
  const Vec3 center = grid_.point(slot);
  const double reach_sq = distance_sq_[slot];
  if (reach_sq <= grid_.cell() * grid_.cell()) {
    grid_.for_each_near(slot, [&](std::uint32_t other) {
      distance_sq_[other] = std::min(distance_sq_[other], (grid_.point(other) - center).squaredNorm());
    });
    return;
  }
  if (!tree_) tree_.emplace(points_);
  std::vector<Neighbor> found;
  tree_->within(center, std::sqrt(reach_sq), found);
  for (const Neighbor& neighbor : found) {
    double& distance_sq = distance_sq_[slot_of_index_[neighbor.index]];
    distance_sq = std::min(distance_sq, neighbor.distance_sq);
  }
}

Index FarthestQueue::take() {
  for (;;) {
    std::pop_heap(heap_.begin(), heap_.end());
    Entry& top = heap_.back();
    const double current = distance_sq_[top.slot];
    if (current < top.distance_sq) {  // out of date: back into the heap with what holds now
      top.distance_sq = current;
      std::push_heap(heap_.begin(), heap_.end());
      continue;
    }
    const std::uint32_t slot = top.slot;
    heap_.pop_back();
    approach(slot);
    distance_sq_[slot] = -1.0;
    return grid_.index(slot);
  }
}

}  // namespace

std::vector<std::uint32_t> throw_darts(const CellGrid& grid, std::span<const std::uint32_t> order, double radius,
                                       std::size_t limit, const RunContext& context) {
  const double radius_sq = radius * radius;
  std::vector<std::uint8_t> covered(grid.size(), 0);
  std::vector<std::uint32_t> taken;
  for (const std::uint32_t slot : order) {
    if (covered[slot]) continue;
    if (taken.size() == limit) break;
    poll(context, taken.size());
    taken.push_back(slot);
    covered[slot] = 1;
    const Vec3 center = grid.point(slot);
    grid.for_each_near(slot, [&](std::uint32_t other) {
      if ((grid.point(other) - center).squaredNorm() < radius_sq) covered[other] = 1;
    });
  }
  return taken;
}

void fill_farthest(std::span<const Vec3> points, std::size_t count, double reach, std::vector<Index>& chosen,
                   const RunContext& context) {
  if (chosen.size() >= count) return;
  FarthestQueue queue(points, std::max(reach, Lattice::min_cell(bounding_box(points))), chosen, context);
  while (chosen.size() < count) {
    poll(context, chosen.size());
    chosen.push_back(queue.take());
  }
}

}  // namespace shapelight
