#pragma once

#include <Eigen/Core>

namespace shapelight::simplification {

using Vec3f = Eigen::Vector3f;

/// Sum of weighted squared distances to planes (Garland and Heckbert 1997, eq. 2) as a function of the offset d from
/// a point of its own, d.A d + 2 b.d + constant. About the vertex it belongs to, single precision loses nothing: the
/// planes of its own faces pass through it, so that b and the constant start at exactly 0. The constant is kept
/// elsewhere, beside the position.
struct Quadric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  ///< A
  float x = 0, y = 0, z = 0;                             ///< b

  /// Adds the plane through the point with normal n / |n|, times weight.
  void add_plane(const Vec3f& n, float weight) {
    const Vec3f w = weight * n;
    xx += w.x() * n.x();
    xy += w.x() * n.y();
    xz += w.x() * n.z();
    yy += w.y() * n.y();
    yz += w.y() * n.z();
    zz += w.z() * n.z();
  }

  [[nodiscard]] Vec3f times(const Vec3f& d) const {
    return {xx * d.x() + xy * d.y() + xz * d.z(), xy * d.x() + yy * d.y() + yz * d.z(),
            xz * d.x() + yz * d.y() + zz * d.z()};
  }
  [[nodiscard]] Vec3f linear() const { return {x, y, z}; }
  [[nodiscard]] float trace() const { return xx + yy + zz; }

  /// Value at offset d, less the constant.
  [[nodiscard]] float rise(const Vec3f& d) const { return d.dot(times(d) + 2.0f * linear()); }

  /// The same function about the point at offset d.
  [[nodiscard]] Quadric about(const Vec3f& d) const {
    Quadric moved = *this;
    const Vec3f b = times(d) + linear();
    moved.x = b.x();
    moved.y = b.y();
    moved.z = b.z();
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
  [[nodiscard]] Vec3f minimum(float damping) const {
    // A = L D L^T; damping keeps every pivot positive.
    const float i0 = 1.0f / (xx + damping), l1 = xy * i0, l2 = xz * i0;
    const float t = yz - l2 * xy, i1 = 1.0f / (yy + damping - l1 * xy), l3 = t * i1;
    const float i2 = 1.0f / (zz + damping - l2 * xz - l3 * t);
    const float y0 = -x, y1 = -y - l1 * y0, y2 = -z - l2 * y0 - l3 * y1;
    const float z2 = y2 * i2, z1 = y1 * i1 - l3 * z2, z0 = y0 * i0 - l1 * z1 - l2 * z2;
    return {z0, z1, z2};
  }
};

}  // namespace shapelight::simplification
