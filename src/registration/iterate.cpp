#include "registration/iterate.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

constexpr double kRigidTolerance = 1e-6;  // transform files carry about this many digits

}  // namespace

void check_registration_input(const RegistrationCloud& source, const RegistrationCloud& target,
                              const RigidTransform& T_target_source, std::size_t min_points) {
  if (std::min(source.size(), target.size()) < min_points) {
    throw InvalidInput(fmt::format("registration: {} source and {} target points, expected {} or more of each",
                                   source.size(), target.size(), min_points));
  }
  const Eigen::Matrix3d R = T_target_source.linear();
  const bool rigid = T_target_source.matrix().allFinite() &&
                     (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < kRigidTolerance &&
                     R.determinant() > 0.0;
  if (!rigid) throw InvalidInput("registration: the starting pose is not a rotation and a translation");
}

double rotation_angle(const RigidTransform& motion) {
  // Of the half angle's sine and cosine: exact for small angles, where the trace is not.
  const Eigen::Quaterniond q(motion.linear());
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

}  // namespace shapelight
