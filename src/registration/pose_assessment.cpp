#include "shapelight/registration/pose_assessment.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.hpp"
#include "registration/pose_confidence.hpp"
#include "registration/sight.hpp"
#include "registration/surface_pairs.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using namespace registration;

void check(const RegistrationCloud& cloud, std::string_view which) {
  if (cloud.size() < 3) {
    throw InvalidInput(fmt::format("assessing a pose: the {} has {} points, expected 3 or more", which, cloud.size()));
  }
  if (cloud.normal.empty()) throw InvalidInput(fmt::format("assessing a pose: the {} has no normals", which));
}

// Pairs from source to target, then those back.
struct BothWays {
  std::vector<SurfacePair> pairs;
  std::size_t num_forward = 0;
  [[nodiscard]] std::span<const SurfacePair> forward() const { return std::span(pairs).first(num_forward); }
  [[nodiscard]] std::span<const SurfacePair> backward() const { return std::span(pairs).subspan(num_forward); }
};

BothWays pair_both_ways(const RegistrationCloud& source, const RegistrationCloud& target, const RigidTransform& T,
                        const RunContext& context) {
  BothWays both{pair_surfaces(source, target, T, context), source.size()};
  const std::vector<SurfacePair> back = pair_surfaces(target, source, T.inverse(), context);
  both.pairs.insert(both.pairs.end(), back.begin(), back.end());
  forget_sides(both.pairs, source, target);
  return both;
}

// Share of a scan's points that lie on the other; and of the close pairs those that face the same way.
void measure_overlap(const BothWays& both, PoseAssessment& result) {
  const auto count = [&](std::span<const SurfacePair> way, auto&& is) {
    return static_cast<double>(std::count_if(way.begin(), way.end(), is));
  };
  const auto on_other = [&](const SurfacePair& pair) { return is_overlap(pair, result.gate); };
  const double forward = count(both.forward(), on_other);
  const double backward = count(both.backward(), on_other);
  result.overlap = std::max(forward / static_cast<double>(both.forward().size()),
                            backward / static_cast<double>(both.backward().size()));
  const double close = count(both.pairs, [&](const SurfacePair& pair) { return pair.distance <= result.gate; });
  if (close > 0.0) result.normal_agreement = (forward + backward) / close;
}

// A right pose puts next to nothing where a sensor saw that nothing is.
double share_in_free_space(const RegistrationCloud& source, const RegistrationCloud& target, const RigidTransform& T,
                           double gate, const RunContext& context) {
  constexpr double kGates = 3.0;  // in range; surfaces are slanted
  Sight::Count both;
  const auto add = [&](const RegistrationCloud& seer, const RegistrationCloud& seen,
                       const RigidTransform& T_seer_seen) {
    if (!seer.viewpoint) return;
    const Sight::Count count = Sight(seer).count(seen.position, T_seer_seen, kGates * gate, context);
    both.seen_through += count.seen_through;
    both.in_sight += count.in_sight;
  };
  add(target, source, T);
  add(source, target, T.inverse());
  return both.in_sight > 0 ? static_cast<double>(both.seen_through) / static_cast<double>(both.in_sight) : 0.0;
}

constexpr double kRivalPower =
    6.0;  // poses that fit alike share the probability, those that fit half as well have none

ReciprocalError reciprocal_error(const BothWays& both) {
  ReciprocalError error;
  double sum = 0.0, sum_sq = 0.0;
  for (std::size_t i = 0; i < both.num_forward; ++i) {
    const SurfacePair& pair = both.pairs[i];
    if (both.backward()[pair.nearest].nearest != i) continue;
    ++error.pairs;
    sum += pair.distance;
    sum_sq += pair.distance * pair.distance;
  }
  if (error.pairs == 0) return error;
  const double n = static_cast<double>(error.pairs);
  error.share = n / static_cast<double>(both.num_forward);
  error.mean = sum / n;
  error.std = std::sqrt(std::max(0.0, sum_sq / n - error.mean * error.mean));
  return error;
}

// Second moments of the points' motion over the tangent planes: how a turn about `center`, its axis scaled by 1/reach,
// and a slide change the heights of the pairs in the overlap. Each factor takes the normals of one scan, so that their
// errors, which would make a sphere look rough enough to hold on to, average out.
struct Information {
  Matrix6 moments = Matrix6::Zero();
  Vec3 center = Vec3::Zero();
  double reach = 0.0;
  double pairs = 0.0;
};

Information information(const RegistrationCloud& source, const RegistrationCloud& target, const RigidTransform& T,
                        std::span<const SurfacePair> forward, double gate) {
  Information info;
  std::vector<Index> overlap;
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (is_overlap(forward[i], gate)) overlap.push_back(static_cast<Index>(i));
  }
  if (overlap.empty()) return info;
  info.pairs = static_cast<double>(overlap.size());
  for (const Index i : overlap) info.center += T * source.position[i] / info.pairs;
  for (const Index i : overlap) info.reach += (T * source.position[i] - info.center).squaredNorm() / info.pairs;
  info.reach = std::sqrt(info.reach);
  if (info.reach == 0.0) return info;
  for (const Index i : overlap) {
    const Vec3 arm = (T * source.position[i] - info.center) / info.reach;
    const Vec3& there = target.normal[forward[i].nearest];
    Vec3 here = T.linear() * source.normal[i];
    if (here.dot(there) < 0.0) here = -here;
    Vector6 change_here, change_there;
    change_here << arm.cross(here), here;
    change_there << arm.cross(there), there;
    info.moments +=
        (change_here * change_there.transpose() + change_there * change_here.transpose()) / (2.0 * info.pairs);
  }
  return info;
}

// From (turn about center x reach, slide) to (turn about the origin, slide): x' = w x (p - c) + t = w x p + (t - w x
// c).
Matrix6 about_origin(const Matrix6& scaled, const Vec3& center, double reach) {
  Matrix6 move = Matrix6::Identity();
  move.topLeftCorner<3, 3>() /= reach;
  Eigen::Matrix3d cross;
  cross << 0.0, -center.z(), center.y(), center.z(), 0.0, -center.x(), -center.y(), center.x(), 0.0;
  move.bottomLeftCorner<3, 3>() = cross / reach;
  return move * scaled * move.transpose();
}

void measure_conditioning(const Information& info, PoseAssessment& result) {
  if (info.reach == 0.0) return;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(info.moments);
  const Vector6 values = solver.eigenvalues();
  const double largest = values[5];
  const double smallest = std::max(values[0], 1e-12 * largest);
  result.conditioning = smallest / largest;
  const double variance = result.residual * result.residual / info.pairs;
  const Vector6 inverse = values.cwiseMax(smallest).cwiseInverse();
  const Matrix6 covariance =
      variance * solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  result.covariance = about_origin(covariance, info.center, info.reach);

  const Vector6 weakest = solver.eigenvectors().col(0);
  const bool slides = weakest.tail<3>().squaredNorm() >= weakest.head<3>().squaredNorm();
  Vec3 axis = (slides ? weakest.tail<3>() : weakest.head<3>()).normalized();
  Index strongest = 0;
  axis.cwiseAbs().maxCoeff(&strongest);
  if (axis[strongest] < 0.0) axis = -axis;
  axis = (axis.array().abs() < 0.005).select(0.0, axis);  // no "-0.00"
  (slides ? result.weakest.translation : result.weakest.rotation) = axis;
  result.weakest.uncertainty = std::sqrt(variance / smallest);
  result.weakest.name = fmt::format("{} ({:.2f}, {:.2f}, {:.2f})", slides ? "sliding along" : "turning about", axis.x(),
                                    axis.y(), axis.z());
}

}  // namespace

PoseAssessment assess_pose(const RegistrationCloud& source, const RegistrationCloud& target,
                           const RigidTransform& T_target_source, std::span<const double> rivals,
                           const RunContext& context) {
  check(source, "source");
  check(target, "target");
  const BothWays both = pair_both_ways(source, target, T_target_source, context);
  const SurfaceGate gate = find_gate(both.pairs, widest_gate(source, target), narrowest_gate(source, target));

  PoseAssessment result;
  result.reciprocal = reciprocal_error(both);
  result.gate = gate.width;
  result.residual = gate.residual;
  result.contrast = gate.contrast;
  measure_overlap(both, result);
  result.in_free_space = share_in_free_space(source, target, T_target_source, gate.width, context);
  measure_conditioning(information(source, target, T_target_source, both.forward(), gate.width), result);
  for (const double share : rivals) result.rival_weight += std::pow(share, kRivalPower);
  const Judgement judgement = judge_pose(result);
  result.confidence = judgement.confidence;
  result.doubt = judgement.doubt;
  return result;
}

}  // namespace shapelight
