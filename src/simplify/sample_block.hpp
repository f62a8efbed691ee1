#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shapelight/core/types.hpp"

namespace shapelight::simplify {

/// A triangle in a local frame, in the form that many distances to it want.
struct LocalTriangle {
  /// Corners relative to the frame's origin. The normal is zero when the triangle has no area.
  LocalTriangle(const Vec3& a, const Vec3& b, const Vec3& c);

  Vec3 corner[3];
  Vec3 normal;        ///< unit
  Vec3 direction[3];  ///< unit, of edge k from corner k on
  Vec3 outward[3];    ///< unit, in the plane, away from the triangle across edge k
  double length[3];   ///< of edge k
  double double_area;
  /// 2 area / longest edge squared: 0.87 for the equilateral one, 0 for a needle.
  [[nodiscard]] double quality() const;
};

/// Surface samples near one place, in a local frame, laid out for vector units, each with its best triangle so far.
class SampleBlock {
 public:
  std::vector<float> x, y, z;      ///< position
  std::vector<float> nx, ny, nz;   ///< surface normal there
  std::vector<float> weight;       ///< of the squared distance
  std::vector<float> turn;         ///< of 1 - cos(angle of normals); 0: no normal term
  std::vector<float> error;        ///< least weighted error over the triangles offered
  std::vector<std::int32_t> best;  ///< which of them

  /// Room for `count` samples; rounded up with samples of no weight, so that loops need no remainder.
  void resize(std::size_t count);
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Forgets the triangles offered.
  void reset();
  /// Offers a triangle: every sample takes it if its error there is less than before. One without area is passed over.
  void offer(const LocalTriangle& triangle, std::int32_t id);
  /// Sum of the errors.
  [[nodiscard]] double total() const;

 private:
  std::size_t size_ = 0;
};

}  // namespace shapelight::simplify
