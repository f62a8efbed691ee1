#include "registration/normal_equations.hpp"

#include <Eigen/Eigenvalues>

namespace shapelight {
namespace {

// Directions with less than this share of the stiffest one's information are left alone: rounding would steer there.
constexpr double kSmallestEigenvalue = 1e-9;

}  // namespace

NormalEquations::Vector6 NormalEquations::solve() const {
  const Eigen::Matrix<double, 6, 6> H = H_.selfadjointView<Eigen::Upper>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(H);
  const Vector6& values = eigen.eigenvalues();  // ascending
  Vector6 step = Vector6::Zero();
  for (int i = 0; i < 6; ++i) {
    if (values[i] <= kSmallestEigenvalue * values[5]) continue;
    const auto direction = eigen.eigenvectors().col(i);
    step -= direction * (direction.dot(b_) / values[i]);
  }
  return step;
}

RigidTransform NormalEquations::to_motion(const Vector6& step) const {
  const Vec3 omega = inverse_length_ * step.head<3>();
  const double angle = omega.norm();
  RigidTransform motion = RigidTransform::Identity();
  if (angle > 0.0) motion.linear() = Eigen::AngleAxisd(angle, omega / angle).toRotationMatrix();
  motion.translation() = center_ + step.tail<3>() - motion.linear() * center_;
  return motion;
}

}  // namespace shapelight
