#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shapelight/core/error.hpp"
#include "spatial/triangle_tree_impl.hpp"

namespace shapelight {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A ray in the tree's frame, its direction of length one.
class Ray {
 public:
  Ray(const Vec3& origin, const Vec3& direction) : origin_(origin) {
    direction.cwiseAbs().maxCoeff(&z_);
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    shear_ = {direction[x_] / direction[z_], direction[y_] / direction[z_], 1.0 / direction[z_]};
    // A finite slope keeps 0 x infinity out of the boxes' test.
    for (int k = 0; k < 3; ++k) slope_[k] = std::clamp(1.0 / direction[k], -kSteepest, kSteepest);
    // Wider boxes than the roundings of both tests, so that no box hides a triangle that the ray meets.
    pad_ = 1e-12 * (1.0 + origin.cwiseAbs().maxCoeff());
  }

  // Where the ray enters a box of a node; infinity when it misses it.
  [[nodiscard]] double enters(const BoxNode& node, std::size_t child) const {
    double from = 0.0, to = kInfinity;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = (node.min[axis][child] - pad_ - origin_[axis]) * slope_[axis];
      const double high = (node.max[axis][child] + pad_ - origin_[axis]) * slope_[axis];
      if (!(low <= kInfinity)) return kInfinity;  // NaN: an unused place
      from = std::max(from, std::min(low, high));
      to = std::min(to, std::max(low, high));
    }
    return from <= to * (1.0 + 1e-15) ? from * (1.0 - 1e-15) : kInfinity;
  }

  // Distance to the triangle, infinity when the ray misses it. In the frame in which the ray is the z axis, the signs
  // of the three edge functions decide; both neighbours of an edge see the same numbers, with opposite signs.
  [[nodiscard]] double meets(const Vec3& corner_a, const Vec3& corner_b, const Vec3& corner_c) const {
    const Vec3 a = corner_a - origin_, b = corner_b - origin_, c = corner_c - origin_;
    const double ax = a[x_] - shear_[0] * a[z_], ay = a[y_] - shear_[1] * a[z_];
    const double bx = b[x_] - shear_[0] * b[z_], by = b[y_] - shear_[1] * b[z_];
    const double cx = c[x_] - shear_[0] * c[z_], cy = c[y_] - shear_[1] * c[z_];
    const double u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return kInfinity;
    const double area = u + v + w;
    if (area == 0.0) return kInfinity;
    const double t = (u * a[z_] + v * b[z_] + w * c[z_]) / area * shear_[2];
    return t > 0.0 ? t : kInfinity;
  }

 private:
  static constexpr double kSteepest = 1e200;
  Vec3 origin_;
  int x_ = 0, y_ = 1, z_ = 2;  // the direction is longest along z
  std::array<double, 3> shear_{};
  Vec3 slope_;
  double pad_ = 0.0;
};

struct Open {
  double enters;
  std::uint32_t child;
};

}  // namespace

TriangleTree::RayHit TriangleTree::Impl::first_hit(const Vec3& origin, const Vec3& direction) const {
  const double length = direction.stableNorm();
  const Vec3 from = to_local(origin);
  if (!from.allFinite() || !std::isfinite(length) || !(length > 0.0)) return {};
  const Ray ray(from, direction / length);
  double nearest = kInfinity;
  const Corners* hit = nullptr;
  std::array<Open, BoxTree::kMaxOpen> open;
  std::size_t count = 0;
  open[count++] = {0.0, 0};
  while (count > 0) {
    const Open next = open[--count];
    if (next.enters > nearest) continue;
    if (next.child & BoxNode::kItem) {
      const Corners& corners_here = corners[next.child & ~BoxNode::kItem];
      const double t = ray.meets(corners_here.a, corners_here.b, corners_here.c);
      if (t == kInfinity || t > nearest || (t == nearest && corners_here.triangle > hit->triangle)) continue;
      nearest = t;
      hit = &corners_here;
      continue;
    }
    const BoxNode& node = tree.nodes[next.child];
    const std::size_t first = count;
    for (std::size_t k = 0; k < BoxNode::kWidth; ++k) {
      const double enters = ray.enters(node, k);
      if (enters == kInfinity || enters > nearest) continue;
      std::size_t at = count++;
      for (; at > first && open[at - 1].enters < enters; --at) open[at] = open[at - 1];
      open[at] = {enters, node.child[k]};  // the nearest on top
    }
  }
  if (hit == nullptr) return {};
  const Vec3 point = from + nearest * (direction / length);
  const Vec3 normal = (hit->b - hit->a).cross(hit->c - hit->a);
  return {hit->triangle, nearest / scale / length, center + point / scale, normal.stableNormalized()};
}

TriangleTree::RayHit TriangleTree::first_hit(const Vec3& origin, const Vec3& direction) const {
  if (!impl_) throw InvalidInput("triangle tree: is empty, expected one made from a mesh");
  return impl_->first_hit(origin, direction);
}

}  // namespace shapelight
