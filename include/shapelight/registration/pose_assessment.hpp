#pragma once

#include <Eigen/Core>
#include <string>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Errors over reciprocal correspondences: p and q with q the target point nearest to T p and p the source point
/// nearest to T^-1 q. No distance gate (paper, section III.B).
struct ReciprocalError {
  std::size_t pairs = 0;
  double share = 0.0;  ///< [1] of the source points that have one
  double mean = 0.0;   ///< [input length unit] the paper's e_mu
  double std = 0.0;    ///< [input length unit] the paper's e_delta
};

/// The direction in which a pose is least determined: a small motion along it changes the fit least.
struct WeakestDirection {
  Vec3 rotation = Vec3::Zero();     ///< [1] axis times weight; about the middle of the overlap, target frame
  Vec3 translation = Vec3::Zero();  ///< [1] direction times weight, target frame
  double uncertainty = 0.0;         ///< [input length unit] standard deviation of the points' motion along it
  std::string name;                 ///< "sliding along (0.00, 0.02, 1.00)", "turning about (...)"
};

/// What speaks for a pose and against it, measured on the full scans.
struct PoseAssessment {
  ReciprocalError reciprocal;
  double overlap = 0.0;           ///< [1] share of the smaller scan's surface that lies on the other one
  double inlier_rms = 0.0;        ///< [input length unit] point-to-plane over the overlap
  double normal_agreement = 0.0;  ///< [1] share of the close pairs whose normals agree
  double conditioning = 0.0;      ///< [1] smallest over largest eigenvalue of the scaled information; 0: undetermined
  Matrix6 covariance = Matrix6::Zero();  ///< of (rotation [rad], translation [length]) about the target frame's origin
  WeakestDirection weakest;
  double confidence = 0.0;  ///< [1] calibrated probability that the pose is right
};

/// Assesses a pose on the full scans. Pre: both clouds have normals and 3 points or more (InvalidInput).
/// Cost: two tree searches per point.
[[nodiscard]] PoseAssessment assess_pose(const RegistrationCloud& source, const RegistrationCloud& target,
                                         const RigidTransform& T_target_source, const RunContext& context = {});

}  // namespace shapelight
