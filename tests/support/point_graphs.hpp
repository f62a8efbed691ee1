#pragma once

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "shapelight/graph/surface_graph.hpp"

/// Surface graphs without edges, for stages that look at points only.
namespace shapelight::test {

inline SurfaceGraph point_graph(std::vector<Vec3> positions, std::vector<Vec3> normals = {},
                                std::vector<double> areas = {}) {
  SurfaceGraph graph;
  const std::size_t n = positions.size();
  graph.position = std::move(positions);
  graph.normal = normals.empty() ? std::vector<Vec3>(n, Vec3::UnitZ()) : std::move(normals);
  graph.area = areas.empty() ? std::vector<double>(n, 1.0) : std::move(areas);
  graph.offsets.assign(n + 1, 0);
  graph.boundary.assign(n, 0);
  graph.outlier.assign(n, 0);
  graph.global_id.resize(n);
  std::iota(graph.global_id.begin(), graph.global_id.end(), Index{0});
  graph.vertex_of_point = graph.global_id;
  graph.total_area = std::accumulate(graph.area.begin(), graph.area.end(), 0.0);
  return graph;
}

/// `count` random points of an ellipsoid with the given half axes, unevenly dense, with outward normals.
inline SurfaceGraph ellipsoid_graph(std::size_t count, const Vec3& axes = {1.0, 0.7, 0.4}, std::uint64_t seed = 7) {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 2.0 * random01(seed, 0, i) - 1.0;
    const double angle = 6.283185307179586 * random01(seed, 1, i);
    const double r = std::sqrt(1.0 - z * z);
    const Vec3 unit(r * std::cos(angle), r * std::sin(angle), z);
    positions.push_back(unit.cwiseProduct(axes));
    normals.push_back(unit.cwiseQuotient(axes).normalized());
  }
  return point_graph(std::move(positions), std::move(normals));
}

inline std::vector<Index> all_vertices(const SurfaceGraph& graph) {
  std::vector<Index> vertices(graph.size());
  std::iota(vertices.begin(), vertices.end(), Index{0});
  return vertices;
}

inline std::vector<Vec3> positions_of(const SurfaceGraph& graph, const std::vector<Index>& vertices) {
  std::vector<Vec3> positions;
  for (const Index v : vertices) positions.push_back(graph.position[v]);
  return positions;
}

/// Largest distance from a point to its nearest sample, by brute force.
inline double brute_coverage(const std::vector<Vec3>& points, const std::vector<Vec3>& samples) {
  double worst = 0.0;
  for (const Vec3& p : points) {
    double nearest = HUGE_VAL;
    for (const Vec3& q : samples) nearest = std::min(nearest, (p - q).squaredNorm());
    worst = std::max(worst, nearest);
  }
  return std::sqrt(worst);
}

/// Smallest distance of two samples, by brute force.
inline double brute_spacing(const std::vector<Vec3>& samples) {
  double nearest = HUGE_VAL;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (samples[i] - samples[j]).squaredNorm());
  }
  return std::sqrt(nearest);
}

}  // namespace shapelight::test
