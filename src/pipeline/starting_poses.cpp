#include "pipeline/starting_poses.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "registration/surface_pairs.hpp"
#include "shapelight/registration/coarse_alignment.hpp"

namespace shapelight {
namespace {

// Mean kernel weight over pairs that face the same way.
double mean_fit(std::span<const registration::SurfacePair> pairs, double reach) {
  double sum = 0.0;
  for (const registration::SurfacePair& pair : pairs) {
    if (!registration::is_overlap(pair, reach)) continue;
    const double share = pair.distance / reach;
    sum += 1.0 - share * share;
  }
  return pairs.empty() ? 0.0 : sum / static_cast<double>(pairs.size());
}

// Motions that bring much of a scan onto itself.
std::vector<RigidTransform> self_similarities(const DescribedPoints& described, double diagonal,
                                              const RunContext& context) {
  constexpr double kEnough = 0.25;  // of the matches that the scan has with itself in place
  const std::vector<PoseHypothesis> hypotheses = align_coarsely(described, described, {.same_side = true}, context);
  std::vector<RigidTransform> motions;
  for (const PoseHypothesis& hypothesis : hypotheses) {
    const bool is_rest = are_alike(hypothesis.T_target_source, RigidTransform::Identity(), diagonal);
    if (!is_rest && hypothesis.support >= kEnough * hypotheses.front().support) {
      motions.push_back(hypothesis.T_target_source);
    }
  }
  return motions;
}

}  // namespace

StartingPoses find_starting_poses(const PreparedScan& source, const PreparedScan& target, const RunContext& context) {
  const double spacing = std::max(coarse_spacing(source.full), coarse_spacing(target.full));
  const DescribedPoints described_source =
      describe_points(source.full, source.keypoints, spacing, context.phase(0.0, 0.4, "describe keypoints"));
  const DescribedPoints described_target =
      describe_points(target.full, target.keypoints, spacing, context.phase(0.4, 0.8, "describe keypoints"));
  const bool same_side = source.full.viewpoint.has_value() && target.full.viewpoint.has_value();

  StartingPoses starts;
  for (const PoseHypothesis& hypothesis : align_coarsely(described_source, described_target, {.same_side = same_side},
                                                         context.phase(0.8, 0.9, "match keypoints"))) {
    starts.poses.push_back({hypothesis.T_target_source, true});
  }
  RigidTransform in_place = RigidTransform::Identity();
  in_place.translation() = source.origin - target.origin;
  starts.poses.push_back({in_place, false});
  starts.T_source_source =
      self_similarities(described_source, source.full.diagonal, context.phase(0.9, 1.0, "match keypoints"));
  return starts;
}

double fit_of_samples(const PreparedScan& source, const PreparedScan& target, const RigidTransform& T_target_source,
                      const RunContext& context) {
  const double reach = std::max(0.01 * std::min(source.full.diagonal, target.full.diagonal),
                                registration::narrowest_gate(source.full, target.full));
  std::vector<registration::SurfacePair> forward =
      registration::pair_surfaces(source.samples, target.full, T_target_source, context);
  std::vector<registration::SurfacePair> backward =
      registration::pair_surfaces(target.samples, source.full, T_target_source.inverse(), context);
  registration::forget_sides(forward, source.full, target.full);
  registration::forget_sides(backward, source.full, target.full);
  return std::max(mean_fit(forward, reach), mean_fit(backward, reach));
}

bool are_alike(const RigidTransform& a, const RigidTransform& b, double diagonal) {
  constexpr double kAngle = 10.0 * std::numbers::pi / 180.0;
  constexpr double kShift = 0.05;  // of the diagonal
  const RigidTransform difference = a.inverse() * b;
  const double angle = Eigen::AngleAxisd(difference.linear()).angle();
  return angle < kAngle && difference.translation().norm() < kShift * diagonal;
}

}  // namespace shapelight
