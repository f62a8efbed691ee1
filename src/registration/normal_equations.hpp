#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "shapelight/core/types.hpp"

namespace shapelight {

/// Gauss-Newton system of a small motion x -> x + omega x (x - center) + v for costs r^T M r of the pairs' differences
/// r = x - q. Rotations are counted in `length`, so that all six unknowns have the unit of a length.
class NormalEquations {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  NormalEquations(const Vec3& center, double length) : center_(center), inverse_length_(1.0 / length) {}

  /// Cost (r . n)^2 (Chen and Medioni 1992).
  void add_plane(const Vec3& x, const Vec3& r, const Vec3& n) {
    const double distance = r.dot(n);
    Vector6 J;
    J << inverse_length_ * (x - center_).cross(n), n;
    H_.noalias() += J * J.transpose();
    b_ += distance * J;
    cost_ += distance * distance;
  }
  /// Cost r^T M r, M symmetric.
  void add_matrix(const Vec3& x, const Vec3& r, const Eigen::Matrix3d& M) {
    const Vec3 arm = inverse_length_ * (x - center_);
    const Vec3 Mr = M * r;
    Eigen::Matrix3d arm_M;  // [arm]x M; M is symmetric, so its columns are M's rows
    for (int j = 0; j < 3; ++j) arm_M.col(j) = arm.cross(Vec3(M.col(j)));
    for (int i = 0; i < 3; ++i) H_.block<1, 3>(i, 0) += arm.cross(Vec3(arm_M.row(i))).transpose();  // -[arm]x M [arm]x
    H_.block<3, 3>(0, 3) += arm_M;
    H_.block<3, 3>(3, 3) += M;
    b_.head<3>() += arm.cross(Mr);
    b_.tail<3>() += Mr;
    cost_ += r.dot(Mr);
  }
  NormalEquations& operator+=(const NormalEquations& other) {
    H_ += other.H_;
    b_ += other.b_;
    cost_ += other.cost_;
    return *this;
  }

  [[nodiscard]] double cost() const { return cost_; }
  /// The small motion (omega times length, v) that minimises the linearised cost. Directions that the pairs leave open
  /// are not moved.
  [[nodiscard]] Vector6 solve() const;
  /// A small motion as an exact rigid one.
  [[nodiscard]] RigidTransform to_motion(const Vector6& step) const;

 private:
  Vec3 center_;
  double inverse_length_;
  Eigen::Matrix<double, 6, 6> H_ = Eigen::Matrix<double, 6, 6>::Zero();  // lower left block unused by add_matrix
  Vector6 b_ = Vector6::Zero();
  double cost_ = 0.0;
};

}  // namespace shapelight
