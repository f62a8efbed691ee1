#include "registration/soft_matches.hpp"

#include <algorithm>
#include <cmath>

namespace shapelight {

void SoftMatches::collect(const ClosestPoints& forward, const ClosestPoints& backward) {
  matches_.clear();
  for (std::size_t i = 0; i < forward.size(); ++i) {
    for (const Neighbor& match : forward.matches(i)) {
      if (match.index == kNoIndex) break;
      matches_.push_back({static_cast<Index>(i), match.index, match.distance_sq});
    }
  }
  for (std::size_t j = 0; j < backward.size(); ++j) {
    for (const Neighbor& match : backward.matches(j)) {
      if (match.index == kNoIndex) break;
      const std::span<const Neighbor> known = forward.matches(match.index);
      const bool twice = std::any_of(known.begin(), known.end(), [&](const Neighbor& k) { return k.index == j; });
      if (!twice) matches_.push_back({match.index, static_cast<Index>(j), match.distance_sq});
    }
  }
}

void SoftMatches::weigh(double sigma, double kappa, int balance_passes) {
  for (SoftMatch& match : matches_) {
    match.weight = std::exp(0.5 * (kappa * kappa - match.distance_sq / (sigma * sigma)));
  }
  // The normalised weight is row * weight * column; the slack cells become row and column themselves.
  std::fill(column_.begin(), column_.end(), 1.0);
  for (int pass = 0; pass < balance_passes; ++pass) {
    std::fill(row_.begin(), row_.end(), 1.0);
    for (const SoftMatch& match : matches_) row_[match.source] += match.weight * column_[match.target];
    for (double& sum : row_) sum = 1.0 / sum;
    std::fill(column_.begin(), column_.end(), 1.0);
    for (const SoftMatch& match : matches_) column_[match.target] += match.weight * row_[match.source];
    for (double& sum : column_) sum = 1.0 / sum;
  }
  for (SoftMatch& match : matches_) match.weight *= row_[match.source] * column_[match.target];
}

}  // namespace shapelight
