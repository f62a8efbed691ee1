#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/triangle_mesh.hpp"

namespace shapelight {

/// Closest points on a triangle mesh, and where rays meet it, exact to the rounding of doubles at any offset: a tree of
/// single precision boxes, four to a node (Wald, Benthin and Boulos 2008), that bound from below, and triangles in
/// double precision. Cost: O(n log n) time to build, about 120 bytes per triangle; O(log n) per query near the surface.
class TriangleTree {
 public:
  struct Hit {
    Index triangle = kNoIndex;
    Vec3 point = Vec3::Zero();  ///< closest point, on the triangle
    double distance_sq = 0.0;   ///< [squared length]
  };
  struct RayHit {
    Index triangle = kNoIndex;   ///< kNoIndex: the ray meets nothing
    double distance = 0.0;       ///< [lengths of the direction] from the origin
    Vec3 point = Vec3::Zero();   ///< there
    Vec3 normal = Vec3::Zero();  ///< unit, of the triangle, by its winding
    [[nodiscard]] explicit operator bool() const { return triangle != kNoIndex; }
  };

  TriangleTree();
  /// Keeps a copy of what it needs. Throws InvalidInput (index out of range, non-finite corner, no triangle),
  /// Cancelled.
  explicit TriangleTree(const TriangleMesh& mesh, const RunContext& context = {});
  ~TriangleTree();
  TriangleTree(TriangleTree&&) noexcept;
  TriangleTree& operator=(TriangleTree&&) noexcept;

  [[nodiscard]] std::size_t size() const;
  /// The closest triangle; of equally close ones the smallest index. `hint`: a triangle thought to be near (or
  /// kNoIndex); it speeds the search up and never changes the result. A query that is not finite gets kNoIndex and a
  /// distance of NaN. Safe to call from many threads. Throws InvalidInput when no mesh was given.
  [[nodiscard]] Hit closest(const Vec3& query, Index hint = kNoIndex) const;
  /// closest() of many points, in parallel; fastest when points that follow each other are close.
  [[nodiscard]] std::vector<Hit> closest(std::span<const Vec3> queries, const RunContext& context = {}) const;
  /// Where the ray origin + t direction, t > 0, first meets a triangle, from either side; of equally near ones the
  /// smallest index. Nothing slips through between triangles that share corners (Woop, Benthin and Wald 2013).
  /// A ray that is not finite or has no direction meets nothing. Safe to call from many threads. Throws InvalidInput
  /// when no mesh was given. Cost: O(log n) for usual surfaces.
  [[nodiscard]] RayHit first_hit(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Closest point to `query` on the triangle (a, b, c), which may be degenerate (Ericson 2005, section 5.1.5).
[[nodiscard]] Vec3 closest_point_on_triangle(const Vec3& query, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace shapelight
