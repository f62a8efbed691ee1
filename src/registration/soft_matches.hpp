#pragma once

#include <vector>

#include "registration/closest_points.hpp"
#include "registration/rigid_fit.hpp"

namespace shapelight {

/// A source point and a target point that may be the same place.
struct SoftMatch {
  Index source = kNoIndex;
  Index target = kNoIndex;
  double distance_sq = 0.0;
  double weight = 0.0;
};

/// Soft assignment between two clouds, restricted to each point's nearest ones both ways (softassign: Gold et al.
/// 1998).
class SoftMatches {
 public:
  SoftMatches(std::size_t num_source, std::size_t num_target) : row_(num_source), column_(num_target) {}

  /// The candidate pairs that either search found, each once. `forward` holds source points and their matches among the
  /// target, `backward` the reverse.
  void collect(const ClosestPoints& forward, const ClosestPoints& backward);

  /// Weights exp((kappa^2 sigma^2 - d^2) / (2 sigma^2)), made to sum to one over every row and column together with
  /// that point's slack cell, which starts at one (Sinkhorn).
  void weigh(double sigma, double kappa, int balance_passes);

  [[nodiscard]] const std::vector<SoftMatch>& matches() const { return matches_; }

 private:
  std::vector<SoftMatch> matches_;
  std::vector<double> row_;     // scale of each source point's weights
  std::vector<double> column_;  // and of each target point's
};

}  // namespace shapelight
