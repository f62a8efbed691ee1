#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"

namespace shapelight {

/// The k target points nearest to each point of a moving cloud, exactly those that fresh searches would find.
///
/// Between two iterations most answers stay the same, so each point remembers, from the place of its last search (the
/// anchor), a few more candidates than are asked for, and its reach: the distance from the anchor that no other target
/// point is closer than. After a motion by m no stranger is closer than reach - m, so the answer is among the
/// candidates as long as the k-th of them is; else the tree is searched, bounded by where the candidates are now.
class ClosestPoints {
 public:
  /// Pre: both outlive this; k >= 1.
  ClosestPoints(std::span<const Vec3> points, const RegistrationCloud& target, std::size_t k = 1);

  /// Moves the points to T_target_point p and matches them anew; targets farther than `max_distance` do not count.
  /// False: every match is the same as after the last update. Cost: O(k) per point whose answer is among its
  /// candidates.
  bool update(const RigidTransform& T_target_point, const RunContext& context,
              double max_distance = std::numeric_limits<double>::infinity());

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const Vec3& moved(std::size_t i) const { return moved_[i]; }
  /// The k matches of point i, nearest first; index kNoIndex at the end where there are fewer.
  [[nodiscard]] std::span<const Neighbor> matches(std::size_t i) const { return {&match_[i * k_], k_}; }
  [[nodiscard]] const Neighbor& match(std::size_t i) const { return match_[i * k_]; }
  [[nodiscard]] const Vec3& target(const Neighbor& match) const { return target_.position[match.index]; }
  [[nodiscard]] std::size_t searches() const { return searches_; }  ///< of the tree, so far

 private:
  struct Anchor {
    Vec3 place = Vec3::Zero();
    double reach = 0.0;
  };
  struct Change {
    bool matches = false;
    std::size_t searches = 0;
  };
  Change update_range(std::size_t begin, std::size_t end, double max_distance);
  bool choose(std::size_t i, double max_distance, std::span<Neighbor> best) const;
  void search(std::size_t i, double max_distance, std::vector<Neighbor>& found);

  std::span<const Vec3> points_;
  const RegistrationCloud& target_;
  std::size_t k_;
  std::size_t num_candidates_;
  std::vector<Vec3> moved_;
  std::vector<Anchor> anchor_;
  std::vector<Index> candidate_;  // num_candidates_ per point, kNoIndex at the end where there are fewer
  std::vector<Neighbor> match_;   // k_ per point
  std::size_t searches_ = 0;
};

}  // namespace shapelight
