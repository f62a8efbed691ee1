#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shapelight/core/types.hpp"

namespace shapelight::simplification {

/// A triangle in a local frame: corners relative to the frame's origin.
struct LocalTriangle {
  LocalTriangle(const Vec3& a, const Vec3& b, const Vec3& c);

  Vec3 corner[3];
  Vec3 normal;  ///< unit; zero when the triangle has no area
  double double_area;
  double longest_sq;  ///< longest edge, squared
  /// 2 area / longest edge squared: 0.87 for the equilateral one, 0 for a needle.
  [[nodiscard]] double quality() const { return longest_sq > 0.0 ? double_area / longest_sq : 0.0; }
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

}  // namespace shapelight::simplification
