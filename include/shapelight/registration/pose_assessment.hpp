#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Errors over reciprocal correspondences: p and q with q the target point nearest to T p, and p the source point
/// nearest to T^-1 q. No distance gate (paper, section III.B).
struct ReciprocalError {
  std::size_t pairs = 0;
  double share = 0.0;  ///< [1] of the source points that have one
  double mean = 0.0;   ///< [input length unit] the paper's e_mu
  double std = 0.0;    ///< [input length unit] the paper's e_delta
};

/// The motion that changes the fit least: what the surfaces do not tell about the pose.
struct WeakestDirection {
  Vec3 rotation = Vec3::Zero();     ///< axis of a turn about the middle of the overlap; zero when it is a slide
  Vec3 translation = Vec3::Zero();  ///< direction of a slide; zero when it is a turn
  double uncertainty = 0.0;  ///< [input length unit] standard deviation of the points along it, were errors independent
  std::string name;          ///< "sliding along (0.00, 0.02, 1.00)", "turning about (1.00, 0.00, 0.00)"; target frame
};

/// What speaks for a pose and against it, measured on the full scans.
struct PoseAssessment {
  ReciprocalError reciprocal;
  double gate = 0.0;     ///< [input length unit] how close surfaces must come to count as one, from the residuals
  double overlap = 0.0;  ///< [1] share of a scan's points within the gate of the other; of the scan that has more
  double normal_agreement = 0.0;  ///< [1] share of those pairs whose normals agree
  double residual = 0.0;          ///< [input length unit] point-to-plane over the overlap: 1.4826 times the median
  double in_free_space =
      0.0;  ///< [1] share of the points that a sensor looked through, of those in its sight; 0: unknown
  double contrast =
      0.0;  ///< [1] how much more often surfaces lie within the gate than chance would have them, see below
  double conditioning = 0.0;  ///< [1] smallest over largest eigenvalue of the scaled information; 0: undetermined
  Matrix6 covariance = Matrix6::Zero();  ///< of (turn [rad] about, slide [length] of) the target's origin
  WeakestDirection weakest;
  double rival_weight = 0.0;  ///< [1] of the rivals beside this pose: the sum of their shares to the 6th power
  double confidence = 0.0;    ///< [1] calibrated share of right poses among poses that look like this one
  std::string doubt;          ///< what speaks most against it: "the scans overlap by 4 % only", ...; may be empty
};

/// Assesses a pose on the full scans: how far they overlap, how well they fit there, and whether that fit determines
/// the pose. The gate starts at 3 % of the smaller diagonal and shrinks to six residuals as long as the residuals
/// shrink with it: on a right pose they do, to the noise and the point spacing; on a wrong one they fill any gate
/// evenly. `rivals` [1]: how well other poses fit that were tried, as shares of how well this one does.
/// The confidence was calibrated on registrations of known truth (docs/register.md), right meaning within 3 degrees and
/// 2 % of the diagonal.
/// Pre: both clouds have normals and 3 points or more (InvalidInput). Cost: two tree searches per point.
[[nodiscard]] PoseAssessment assess_pose(const RegistrationCloud& source, const RegistrationCloud& target,
                                         const RigidTransform& T_target_source, std::span<const double> rivals = {},
                                         const RunContext& context = {});

}  // namespace shapelight
