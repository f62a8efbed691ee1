#pragma once

#include <Eigen/Core>

#include "shapelight/core/types.hpp"

namespace shapelight {

/// The motion that brings weighted pairs of points closest together, in the sense of least squares (Kabsch 1976; equal
/// to Horn's quaternions). Moments are taken about `origin`, which should be near the points.
class RigidFit {
 public:
  explicit RigidFit(const Vec3& origin) : origin_(origin) {}

  void add(const Vec3& from, const Vec3& to, double weight = 1.0) {
    const Vec3 x = from - origin_;
    const Vec3 y = weight * (to - origin_);
    weight_ += weight;
    from_ += weight * x;
    to_ += y;
    product_.noalias() += x * y.transpose();
  }
  RigidFit& operator+=(const RigidFit& other) {
    weight_ += other.weight_;
    from_ += other.from_;
    to_ += other.to_;
    product_ += other.product_;
    return *this;
  }

  /// The motion from -> to. Directions that the pairs leave open (turning collinear points about their line, or a
  /// single place about itself) are not moved. Identity without weight.
  [[nodiscard]] RigidTransform solve() const;

 private:
  Vec3 origin_;
  double weight_ = 0.0;
  Vec3 from_ = Vec3::Zero();
  Vec3 to_ = Vec3::Zero();
  Eigen::Matrix3d product_ = Eigen::Matrix3d::Zero();
};

}  // namespace shapelight
