#include "registration/rigid_fit.hpp"

#include <Eigen/SVD>

namespace shapelight {
namespace {

// A pull towards no rotation, relative to the pairs' own: it settles what they leave open, and is far below what
// stopping tolerances can see elsewhere. A fixed point stays one.
constexpr double kStillness = 1e-9;

}  // namespace

RigidTransform RigidFit::solve() const {
  RigidTransform motion = RigidTransform::Identity();
  if (!(weight_ > 0.0)) return motion;
  const Vec3 from = from_ / weight_;
  const Vec3 to = to_ / weight_;
  Eigen::Matrix3d H = product_ - weight_ * from * to.transpose();
  H.diagonal().array() += kStillness * H.norm();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  const Vec3 signs(1.0, 1.0, (V * U.transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  motion.linear() = V * signs.asDiagonal() * U.transpose();
  motion.translation() = (origin_ + to) - motion.linear() * (origin_ + from);
  return motion;
}

}  // namespace shapelight
