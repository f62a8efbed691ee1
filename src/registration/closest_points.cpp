#include "registration/closest_points.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kSpareCandidates = 4;
constexpr std::size_t kChunk = 4096;   // fewer points are matched faster by one thread
constexpr double kSearchMargin = 1.5;  // of the largest distance that counts: room to move before the next search
constexpr double kRounding = 1e-12;    // more than the relative error of a computed distance

// Rounds as the tree does, so that bounds and ties agree to the last bit.
double distance_sq(const Vec3& a, const Vec3& b) {
  const double dx = b.x() - a.x();
  const double dy = b.y() - a.y();
  const double dz = b.z() - a.z();
  return dx * dx + dy * dy + dz * dz;
}

void insert(std::span<Neighbor> best, const Neighbor& found) {
  if (!(found < best.back())) return;
  std::size_t place = best.size() - 1;
  for (; place > 0 && found < best[place - 1]; --place) best[place] = best[place - 1];
  best[place] = found;
}

}  // namespace

ClosestPoints::ClosestPoints(std::span<const Vec3> points, const RegistrationCloud& target, std::size_t k)
    : points_(points),
      target_(target),
      k_(k),
      num_candidates_(k + kSpareCandidates),
      moved_(points.size()),
      anchor_(points.size()),
      candidate_(points.size() * num_candidates_, kNoIndex),
      match_(points.size() * k) {}

bool ClosestPoints::update(const RigidTransform& T_target_point, const RunContext& context, double max_distance) {
  const Change change = parallel::reduce_chunks(
      context, size(), Change{},
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) moved_[i] = T_target_point * points_[i];
        return update_range(begin, end, max_distance);
      },
      [](const Change& a, const Change& b) {
        return Change{a.matches || b.matches, a.searches + b.searches};
      },
      kChunk);
  searches_ += change.searches;
  return change.matches;
}

ClosestPoints::Change ClosestPoints::update_range(std::size_t begin, std::size_t end, double max_distance) {
  Change change;
  std::vector<Neighbor> found;
  std::vector<Neighbor> best(k_);
  for (std::size_t i = begin; i < end; ++i) {
    if (!choose(i, max_distance, best)) {
      search(i, max_distance, found);
      ++change.searches;
      choose(i, max_distance, best);
    }
    for (std::size_t j = 0; j < k_; ++j) {
      Neighbor& match = match_[i * k_ + j];
      change.matches |= match.index != best[j].index;
      match = best[j];
    }
  }
  return change;
}

// The best k candidates within the distance; false when a target point that is none could be closer.
bool ClosestPoints::choose(std::size_t i, double max_distance, std::span<Neighbor> best) const {
  const double limit = max_distance * max_distance;
  std::fill(best.begin(), best.end(), Neighbor{limit, kNoIndex});
  for (std::size_t j = i * num_candidates_; j < (i + 1) * num_candidates_ && candidate_[j] != kNoIndex; ++j) {
    insert(best, {distance_sq(moved_[i], target_.position[candidate_[j]]), candidate_[j]});
  }
  const double motion = std::sqrt(distance_sq(moved_[i], anchor_[i].place));
  return (std::sqrt(best.back().distance_sq) + motion) * (1.0 + kRounding) < anchor_[i].reach;
}

void ClosestPoints::search(std::size_t i, double max_distance, std::vector<Neighbor>& found) {
  const std::span<Index> candidates(&candidate_[i * num_candidates_], num_candidates_);
  double limit = kSearchMargin * kSearchMargin * max_distance * max_distance;
  if (candidates.back() != kNoIndex) {
    double farthest = 0.0;
    for (const Index j : candidates) farthest = std::max(farthest, distance_sq(moved_[i], target_.position[j]));
    limit = std::min(limit, farthest);
  }
  target_.tree.nearest(moved_[i], num_candidates_, found, limit);
  for (std::size_t j = 0; j < num_candidates_; ++j) candidates[j] = j < found.size() ? found[j].index : kNoIndex;
  anchor_[i] = {moved_[i], std::sqrt(found.size() == num_candidates_ ? found.back().distance_sq : limit)};
}

}  // namespace shapelight
