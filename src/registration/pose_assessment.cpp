#include "shapelight/registration/pose_assessment.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.hpp"
#include "registration/surface_pairs.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using registration::pair_surfaces;
using registration::SurfacePair;

constexpr double kWidestGate = 0.03;    // of the smaller diagonal
constexpr double kGateResiduals = 6.0;  // the gate is this many residuals wide,
constexpr double kGateSpacings = 3.0;   // but never closer than the points allow
constexpr double kNormalsAgree = 0.7;   // cosine, 45 degrees
constexpr double kGaussian = 1.4826;    // standard deviation over median of absolute values

void check(const RegistrationCloud& cloud, std::string_view which) {
  if (cloud.size() < 3) {
    throw InvalidInput(fmt::format("assessing a pose: the {} has {} points, expected 3 or more", which, cloud.size()));
  }
  if (cloud.normal.empty()) throw InvalidInput(fmt::format("assessing a pose: the {} has no normals", which));
}

// Source to target and back.
struct BothWays {
  std::vector<SurfacePair> forward, backward;
};

// Normals of a scan may point to the wrong side as a whole, when nobody knows where its sensor stood.
void make_normals_agree(BothWays& pairs, double reach) {
  double sum = 0.0;
  for (const auto* way : {&pairs.forward, &pairs.backward}) {
    for (const SurfacePair& pair : *way) {
      if (pair.distance <= reach) sum += pair.cosine;
    }
  }
  if (sum >= 0.0) return;
  for (auto* way : {&pairs.forward, &pairs.backward}) {
    for (SurfacePair& pair : *way) pair.cosine = -pair.cosine;
  }
}

// Of pairs that face the same way: the heights of those within the gate.
std::vector<double> heights_within(const BothWays& pairs, double gate) {
  std::vector<double> heights;
  for (const auto* way : {&pairs.forward, &pairs.backward}) {
    for (const SurfacePair& pair : *way) {
      if (pair.distance <= gate && pair.cosine >= kNormalsAgree) heights.push_back(std::abs(pair.height));
    }
  }
  return heights;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void find_gate(const BothWays& pairs, double widest, double narrowest, PoseAssessment& result) {
  std::vector<double> heights = heights_within(pairs, widest);
  const double num_wide = static_cast<double>(heights.size());
  result.gate = widest;
  result.residual = kGaussian * median(heights);
  for (int step = 0; step < 20; ++step) {
    const double gate = std::max(narrowest, std::min(result.gate, kGateResiduals * result.residual));
    if (gate >= 0.99 * result.gate) break;
    heights = heights_within(pairs, gate);
    result.gate = gate;
    result.residual = kGaussian * median(heights);
  }
  if (num_wide > 0.0) {
    const double share = static_cast<double>(heights.size()) / num_wide;
    result.contrast = share * widest / std::max(result.gate, 1e-300);
  }
}

// Shares of both scans within the gate, and of the close pairs those that face the same way.
void measure_overlap(const BothWays& pairs, PoseAssessment& result) {
  std::size_t close = 0, agreeing = 0;
  for (const auto* way : {&pairs.forward, &pairs.backward}) {
    std::size_t agreeing_here = 0;
    for (const SurfacePair& pair : *way) {
      if (pair.distance > result.gate) continue;
      ++close;
      agreeing_here += pair.cosine >= kNormalsAgree;
    }
    agreeing += agreeing_here;
    result.overlap = std::max(result.overlap, static_cast<double>(agreeing_here) / static_cast<double>(way->size()));
  }
  if (close > 0) result.normal_agreement = static_cast<double>(agreeing) / static_cast<double>(close);
}

ReciprocalError reciprocal_error(const BothWays& pairs) {
  ReciprocalError error;
  double sum = 0.0, sum_sq = 0.0;
  for (std::size_t i = 0; i < pairs.forward.size(); ++i) {
    const SurfacePair& pair = pairs.forward[i];
    if (pairs.backward[pair.nearest].nearest != i) continue;
    ++error.pairs;
    sum += pair.distance;
    sum_sq += pair.distance * pair.distance;
  }
  if (error.pairs == 0) return error;
  const double n = static_cast<double>(error.pairs);
  error.share = n / static_cast<double>(pairs.forward.size());
  error.mean = sum / n;
  error.std = std::sqrt(std::max(0.0, sum_sq / n - error.mean * error.mean));
  return error;
}

// Second moments of the points' motion over the tangent planes: how a turn about `center`, its axis scaled by 1/reach,
// and a slide change the heights of the pairs in the overlap.
struct Information {
  Matrix6 moments = Matrix6::Zero();
  Vec3 center = Vec3::Zero();
  double reach = 0.0;
  double pairs = 0.0;
};

Information information(const RegistrationCloud& source, const RegistrationCloud& target, const RigidTransform& T,
                        std::span<const SurfacePair> forward, double gate) {
  Information info;
  const auto for_each_pair = [&](auto&& use) {
    for (std::size_t i = 0; i < forward.size(); ++i) {
      const SurfacePair& pair = forward[i];
      if (pair.distance <= gate && pair.cosine >= kNormalsAgree)
        use(T * source.position[i], target.normal[pair.nearest]);
    }
  };
  for_each_pair([&](const Vec3& point, const Vec3&) { info.center += point, info.pairs += 1.0; });
  if (info.pairs == 0.0) return info;
  info.center /= info.pairs;
  for_each_pair([&](const Vec3& point, const Vec3&) { info.reach += (point - info.center).squaredNorm(); });
  info.reach = std::sqrt(info.reach / info.pairs);
  if (info.reach == 0.0) return info;
  for_each_pair([&](const Vec3& point, const Vec3& normal) {
    Vector6 change;
    change << (point - info.center).cross(normal) / info.reach, normal;
    info.moments += change * change.transpose();
  });
  info.moments /= info.pairs;
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
  (slides ? result.weakest.translation : result.weakest.rotation) = axis;
  result.weakest.uncertainty = std::sqrt(variance / smallest);
  result.weakest.name = fmt::format("{} ({:.2f}, {:.2f}, {:.2f})", slides ? "sliding along" : "turning about",
                                    axis.x() + 0.0, axis.y() + 0.0, axis.z() + 0.0);
}

}  // namespace

PoseAssessment assess_pose(const RegistrationCloud& source, const RegistrationCloud& target,
                           const RigidTransform& T_target_source, const RunContext& context) {
  check(source, "source");
  check(target, "target");
  BothWays pairs{pair_surfaces(source, target, T_target_source, context),
                 pair_surfaces(target, source, T_target_source.inverse(), context)};
  const double widest = kWidestGate * std::min(source.diagonal, target.diagonal);
  make_normals_agree(pairs, widest);

  PoseAssessment result;
  result.reciprocal = reciprocal_error(pairs);
  find_gate(pairs, widest, std::min(widest, kGateSpacings * std::max(source.spacing, target.spacing)), result);
  measure_overlap(pairs, result);
  measure_conditioning(information(source, target, T_target_source, pairs.forward, result.gate), result);
  return result;
}

}  // namespace shapelight
