#pragma once

#include <Eigen/Core>

namespace shapelight::simplification {

/// Sum of weighted squared distances to planes (Garland and Heckbert 1997, eq. 2) as a function of the offset d from
/// a point of its own, d.A d + 2 b.d + constant. About the vertex it belongs to, rounding loses least: the
/// planes of its own faces pass through it, so that b and the constant start at exactly 0. The constant is kept
/// elsewhere, beside the position.
template <class Scalar>
struct Quadric {
  using Vector = Eigen::Matrix<Scalar, 3, 1>;

  Scalar xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  ///< A
  Scalar x = 0, y = 0, z = 0;                             ///< b

  /// Adds the plane through the point with normal n / |n|, times weight.
  void add_plane(const Vector& n, Scalar weight) {
    const Vector w = weight * n;
    xx += w.x() * n.x();
    xy += w.x() * n.y();
    xz += w.x() * n.z();
    yy += w.y() * n.y();
    yz += w.y() * n.z();
    zz += w.z() * n.z();
  }

  [[nodiscard]] Vector times(const Vector& d) const {
    return {xx * d.x() + xy * d.y() + xz * d.z(), xy * d.x() + yy * d.y() + yz * d.z(),
            xz * d.x() + yz * d.y() + zz * d.z()};
  }
  [[nodiscard]] Vector linear() const { return {x, y, z}; }
  void set_linear(const Vector& b) {
    x = b.x();
    y = b.y();
    z = b.z();
  }
  [[nodiscard]] Scalar trace() const { return xx + yy + zz; }

  /// Value at offset d, less the constant.
  [[nodiscard]] Scalar rise(const Vector& d) const { return d.dot(times(d) + Scalar(2) * linear()); }

  /// The same function about the point at offset d.
  [[nodiscard]] Quadric about(const Vector& d) const {
    Quadric moved = *this;
    moved.set_linear(times(d) + linear());
    return moved;
  }

  Quadric& operator+=(const Quadric& o) {
    xx += o.xx;
    xy += o.xy;
    xz += o.xz;
    yy += o.yy;
    yz += o.yz;
    zz += o.zz;
    x += o.x;
    y += o.y;
    z += o.z;
    return *this;
  }

  /// Offset of the least value of the function with `damping` added to the diagonal of A.
  [[nodiscard]] Vector minimum(Scalar damping) const {
    // A = L D L^T; damping keeps every pivot positive.
    const Scalar i0 = Scalar(1) / (xx + damping), l1 = xy * i0, l2 = xz * i0;
    const Scalar t = yz - l2 * xy, i1 = Scalar(1) / (yy + damping - l1 * xy), l3 = t * i1;
    const Scalar i2 = Scalar(1) / (zz + damping - l2 * xz - l3 * t);
    const Scalar y0 = -x, y1 = -y - l1 * y0, y2 = -z - l2 * y0 - l3 * y1;
    const Scalar z2 = y2 * i2, z1 = y1 * i1 - l3 * z2, z0 = y0 * i0 - l1 * z1 - l2 * z2;
    return {z0, z1, z2};
  }
};

}  // namespace shapelight::simplification
