#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/io/io.hpp"

/// The shipped data, and what may be done to an input without changing its shape.
namespace shapelight::testing {

inline Geometry read_data(std::string_view name) { return read_geometry(std::string(SHAPELIGHT_DATA_DIR "/") + std::string(name)); }

/// A random order of [0, count), by hashing.
inline std::vector<Index> random_order(std::size_t count, std::uint64_t seed) {
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return random_bits(seed, 0, a) < random_bits(seed, 0, b); });
  return order;
}

/// The points of a geometry, and its triangles, in another order; point i of the result is point order[i].
inline Geometry reordered(const Geometry& geometry, const std::vector<Index>& order) {
  Geometry result = select_points(geometry, order);
  std::vector<Index> new_index(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) new_index[order[i]] = static_cast<Index>(i);
  for (const Index t : random_order(geometry.triangles.size(), 17)) {
    const Triangle& old = geometry.triangles[t];
    // Starting at another corner keeps the winding.
    result.triangles.push_back({new_index[old[(t + 1) % 3]], new_index[old[(t + 2) % 3]], new_index[old[t % 3]]});
  }
  return result;
}

inline Geometry transformed(Geometry geometry, const Eigen::Matrix3d& linear, const Vec3& shift = Vec3::Zero()) {
  for (Vec3& p : geometry.positions) p = linear * p + shift;
  if (geometry.viewpoint) geometry.viewpoint = linear * *geometry.viewpoint + shift;
  return geometry;
}

/// Only the points: what a scanner's raw cloud of the same object would be.
inline Geometry as_cloud(Geometry geometry) {
  geometry.triangles.clear();
  geometry.corner_texcoords.clear();
  geometry.triangle_attributes = {};
  geometry.grid.reset();
  return geometry;
}

}  // namespace shapelight::testing
