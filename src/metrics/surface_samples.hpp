#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.hpp"
#include "shapelight/data/triangle_mesh.hpp"

namespace shapelight {

/// Twice the area along the direction of the outward normal.
[[nodiscard]] inline Vec3 area_normal(const TriangleMesh& mesh, Index triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3& a = mesh.positions[t[0]];
  return (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a);
}

/// Points spread evenly over a surface: the area, laid out triangle after triangle, is cut into equal strata with one
/// sample each; inside a triangle the samples follow the R2 sequence (Roberts 2018) from a random start.
class SurfaceSamples {
 public:
  struct Sample {
    Index triangle;
    Vec3 point;
  };

  SurfaceSamples(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed, std::uint64_t stream)
      : mesh_(mesh), count_(count), seed_(seed), stream_(stream), area_before_(mesh.triangles.size() + 1, 0.0) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      area_before_[t + 1] = area_before_[t] + 0.5 * area_normal(mesh, static_cast<Index>(t)).norm();
    }
  }

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] double area() const { return area_before_.back(); }

  /// Sample k. `near`: the triangle of a sample at most k, from where the search goes on; 0 is always right.
  [[nodiscard]] Sample at(std::size_t k, Index near) const {
    const double area =
        (static_cast<double>(k) + random01(seed_, stream_, k)) / static_cast<double>(count_) * this->area();
    Index triangle = near;
    while (triangle + 1 < mesh_.triangles.size() && area_before_[triangle + 1] <= area) ++triangle;
    const double step = static_cast<double>(k);
    double u = fraction(random01(seed_, stream_ + 1, triangle) + step * 0.7548776662466927);
    double v = fraction(random01(seed_, stream_ + 2, triangle) + step * 0.5698402909980532);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Triangle& t = mesh_.triangles[triangle];
    const Vec3& a = mesh_.positions[t[0]];
    return {triangle, a + u * (mesh_.positions[t[1]] - a) + v * (mesh_.positions[t[2]] - a)};
  }

  /// The triangle where the stratum of sample k begins, or one before it: a start for at().
  [[nodiscard]] Index triangle_before(std::size_t k) const {
    const double area = static_cast<double>(k) / static_cast<double>(count_) * this->area();
    const auto after = std::upper_bound(area_before_.begin() + 1, area_before_.end(), area);
    return static_cast<Index>(std::min<std::ptrdiff_t>(after - area_before_.begin() - 1,
                                                       static_cast<std::ptrdiff_t>(mesh_.triangles.size()) - 1));
  }

 private:
  [[nodiscard]] static double fraction(double x) { return x - std::floor(x); }

  const TriangleMesh& mesh_;
  std::size_t count_;
  std::uint64_t seed_, stream_;
  std::vector<double> area_before_;  // of each triangle; the whole at the end
};

}  // namespace shapelight
