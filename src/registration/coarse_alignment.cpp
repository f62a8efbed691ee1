#include "shapelight/registration/coarse_alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.hpp"
#include "registration/compatibility.hpp"
#include "registration/match_descriptors.hpp"

namespace shapelight {
namespace {

constexpr double kTolerance = 1.5;    // [spacings] two thinned scans put a point at places that differ by about one
constexpr double kMinCosine = 0.7;    // of normals that agree
constexpr double kNormalWeight = 4;   // [tolerances squared] of a pair of normals against a pair of places
constexpr std::size_t kSeeds = 100;   // matches that groups grow from
constexpr std::size_t kFriends = 20;  // of a seed, that the first pose is fitted to
constexpr int kRefits = 2;
constexpr std::size_t kMinSupport = 4;  // three pairs fit some pose always
constexpr double kAlike = 3.0;          // [tolerances] poses that move the scan apart by less are one
constexpr std::size_t kChunk = 8;       // seeds

std::vector<PlacePair> place_pairs(const DescribedPoints& source, const DescribedPoints& target,
                                   std::span<const Match> matches) {
  std::vector<PlacePair> pairs;
  pairs.reserve(matches.size());
  for (const Match& match : matches) {
    pairs.push_back({source.position[match.source], target.position[match.target], source.normal[match.source],
                     (match.turned ? -1.0 : 1.0) * target.normal[match.target]});
  }
  return pairs;
}

/// The pairs that are compatible with most others, no two at the same places.
std::vector<std::size_t> choose_seeds(std::span<const PlacePair> pairs, const CompatibilityGraph& graph,
                                      double tolerance) {
  std::vector<std::pair<int, std::size_t>> order;
  order.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) order.emplace_back(-graph.degree(i), i);
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> seeds;
  const double near_sq = tolerance * tolerance;
  for (const auto& [degree, i] : order) {
    const PlacePair& pair = pairs[i];
    const bool is_taken = std::any_of(seeds.begin(), seeds.end(), [&](std::size_t s) {
      return (pairs[s].source - pair.source).squaredNorm() < near_sq &&
             (pairs[s].target - pair.target).squaredNorm() < near_sq;
    });
    if (!is_taken) seeds.push_back(i);
    if (seeds.size() == kSeeds) break;
  }
  return seeds;
}

/// The seed and the pairs with which it has most friends in common.
std::vector<std::size_t> closest_friends(const CompatibilityGraph& graph, std::size_t seed) {
  std::vector<std::pair<int, std::size_t>> friends;
  graph.for_each_compatible(seed, [&](std::size_t j) { friends.emplace_back(-graph.common(seed, j), j); });
  const std::size_t count = std::min(kFriends, friends.size());
  std::partial_sort(friends.begin(), friends.begin() + static_cast<std::ptrdiff_t>(count), friends.end());
  std::vector<std::size_t> group{seed};
  for (std::size_t f = 0; f < count; ++f) group.push_back(friends[f].second);
  return group;
}

/// The motion that best brings the chosen sources and their normals onto the targets and theirs (Kabsch 1976).
RigidTransform fit(std::span<const PlacePair> pairs, std::span<const std::size_t> chosen, double tolerance) {
  Vec3 source_mean = Vec3::Zero();
  Vec3 target_mean = Vec3::Zero();
  for (const std::size_t i : chosen) {
    source_mean += pairs[i].source / static_cast<double>(chosen.size());
    target_mean += pairs[i].target / static_cast<double>(chosen.size());
  }
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  const double normal_weight = kNormalWeight * tolerance * tolerance;
  for (const std::size_t i : chosen) {
    correlation += (pairs[i].target - target_mean) * (pairs[i].source - source_mean).transpose();
    correlation += normal_weight * pairs[i].target_normal * pairs[i].source_normal.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 sign = Vec3::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) sign.z() = -1.0;
  RigidTransform T_target_source = RigidTransform::Identity();
  T_target_source.linear() = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  T_target_source.translation() = target_mean - T_target_source.linear() * source_mean;
  return T_target_source;
}

std::vector<std::size_t> agreeing(std::span<const PlacePair> pairs, const RigidTransform& T_target_source,
                                  double tolerance) {
  std::vector<std::size_t> group;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PlacePair& pair = pairs[i];
    if ((T_target_source * pair.source - pair.target).squaredNorm() < tolerance * tolerance &&
        (T_target_source.linear() * pair.source_normal).dot(pair.target_normal) > kMinCosine) {
      group.push_back(i);
    }
  }
  return group;
}

/// The pose of a group, fitted again to whatever agrees with it; no support when that is too little.
PoseHypothesis grow(std::span<const PlacePair> pairs, std::vector<std::size_t> group, double tolerance) {
  PoseHypothesis pose;
  for (int pass = 0; pass <= kRefits; ++pass) {
    if (group.size() < kMinSupport) return {};
    pose.T_target_source = fit(pairs, group, tolerance);
    group = agreeing(pairs, pose.T_target_source, tolerance);
  }
  if (group.size() < kMinSupport) return {};
  pose.support = static_cast<double>(group.size());
  return pose;
}

/// The best supported poses, leaving out those that put the scan where a better one does.
std::vector<PoseHypothesis> distinct(std::vector<PoseHypothesis> poses, std::span<const Vec3> scan, double apart,
                                     int count) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) { return a.support > b.support; });
  Vec3 center = Vec3::Zero();
  for (const Vec3& p : scan) center += p / static_cast<double>(scan.size());
  double radius_sq = 0.0;
  for (const Vec3& p : scan) radius_sq += (p - center).squaredNorm() / static_cast<double>(scan.size());

  std::vector<PoseHypothesis> kept;
  for (const PoseHypothesis& pose : poses) {
    if (pose.support == 0.0 || kept.size() == static_cast<std::size_t>(count)) break;
    const RigidTransform& a = pose.T_target_source;
    const bool is_old = std::any_of(kept.begin(), kept.end(), [&](const PoseHypothesis& other) {
      const RigidTransform& b = other.T_target_source;
      const double angle = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
      return (a * center - b * center).norm() + angle * std::sqrt(radius_sq) < apart;
    });
    if (!is_old) kept.push_back(pose);
  }
  return kept;
}

}  // namespace

std::vector<PoseHypothesis> align_coarsely(const DescribedPoints& source, const DescribedPoints& target,
                                           const CoarseAlignmentOptions& options, const RunContext& context) {
  validate_options(options);
  const double tolerance = kTolerance * std::max(source.spacing, target.spacing);
  const std::vector<PlacePair> pairs =
      place_pairs(source, target, match_descriptors(source, target, options.same_side, context));
  const CompatibilityGraph graph(pairs, tolerance, context);
  const std::vector<std::size_t> seeds = choose_seeds(pairs, graph, tolerance);

  std::vector<PoseHypothesis> poses(seeds.size());
  parallel::for_chunks(
      context, seeds.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
          poses[s] = grow(pairs, closest_friends(graph, seeds[s]), tolerance);
        }
      },
      kChunk);
  return distinct(std::move(poses), source.position, kAlike * tolerance, options.max_hypotheses);
}

}  // namespace shapelight
