#pragma once

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "shapelight/graph/surface_graph.hpp"
#include "support/shapes.hpp"

/// Surface graphs made the plain way, vertex i of the graph being vertex i of the input: no reordering.
namespace shapelight::testing {

/// A graph over these edges. Areas are 1, weights 1, normals up, unless the caller sets them.
inline SurfaceGraph graph_of_edges(std::vector<Vec3> positions, const std::set<std::pair<Index, Index>>& edges) {
  SurfaceGraph graph;
  const std::size_t n = positions.size();
  std::vector<std::vector<Index>> neighbors(n);
  double length = 0.0;
  for (const auto& [a, b] : edges) {
    neighbors[a].push_back(b);
    neighbors[b].push_back(a);
    length += (positions[a] - positions[b]).norm();
  }
  graph.offsets.push_back(0);
  for (auto& list : neighbors) {
    std::sort(list.begin(), list.end());
    graph.neighbors.insert(graph.neighbors.end(), list.begin(), list.end());
    graph.offsets.push_back(static_cast<std::uint32_t>(graph.neighbors.size()));
  }
  graph.weight.assign(graph.neighbors.size(), 1.0f);
  graph.position = std::move(positions);
  graph.normal.assign(n, Vec3::UnitZ());
  graph.area.assign(n, 1.0);
  graph.total_area = static_cast<double>(n);
  graph.boundary.assign(n, 0);
  graph.outlier.assign(n, 0);
  graph.global_id.resize(n);
  std::iota(graph.global_id.begin(), graph.global_id.end(), Index{0});
  graph.vertex_of_point = graph.global_id;
  graph.mean_edge_length = edges.empty() ? 0.0 : length / static_cast<double>(edges.size());
  return graph;
}

/// The graph of a triangle mesh: area-weighted normals, a third of the triangles' area per vertex, and per edge the
/// area of the triangles at it.
inline SurfaceGraph graph_of_mesh(const Shape& shape) {
  std::set<std::pair<Index, Index>> edges;
  for (const Triangle& t : shape.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  }
  SurfaceGraph graph = graph_of_edges(shape.positions, edges);
  graph.area.assign(graph.size(), 0.0);
  graph.normal.assign(graph.size(), Vec3::Zero());
  graph.weight.assign(graph.neighbors.size(), 0.0f);
  graph.total_area = 0.0;
  std::vector<int> faces_at(graph.neighbors.size(), 0);
  for (const Triangle& t : shape.triangles) {
    const Vec3 cross = (graph.position[t[1]] - graph.position[t[0]]).cross(graph.position[t[2]] - graph.position[t[0]]);
    for (std::size_t k = 0; k < 3; ++k) {
      graph.area[t[k]] += cross.norm() / 6.0;
      graph.normal[t[k]] += cross;
      for (const Index other : {t[(k + 1) % 3], t[(k + 2) % 3]}) {
        const auto list = graph.neighbors_of(t[k]);
        const auto e = graph.offsets[t[k]] +
                       static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), other) - list.begin());
        graph.weight[e] += static_cast<float>(cross.norm() / 2.0);
        ++faces_at[e];
      }
    }
    graph.total_area += cross.norm() / 2.0;
  }
  for (Vec3& n : graph.normal) n.normalize();
  for (std::size_t i = 0; i < graph.size(); ++i) {
    for (std::uint32_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      if (faces_at[e] == 1) graph.boundary[i] = 1;
    }
  }
  return graph;
}

/// Symmetric k-nearest-neighbour graph by brute force, with the shape's exact normals: a raw cloud with good normals.
inline SurfaceGraph graph_of_points(const Shape& shape, std::size_t k) {
  std::set<std::pair<Index, Index>> edges;
  const auto n = static_cast<Index>(shape.positions.size());
  std::vector<std::pair<double, Index>> near;
  for (Index i = 0; i < n; ++i) {
    near.clear();
    for (Index j = 0; j < n; ++j) near.emplace_back((shape.positions[j] - shape.positions[i]).squaredNorm(), j);
    const std::size_t count = std::min<std::size_t>(k + 1, n);
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    for (std::size_t m = 0; m < count; ++m) {
      if (near[m].second != i) edges.insert(std::minmax(i, near[m].second));
    }
  }
  SurfaceGraph graph = graph_of_edges(shape.positions, edges);
  graph.normal = shape.normals;
  return graph;
}

/// The graph after a rotation, scaling by `scale` and shift of the surface.
inline SurfaceGraph moved(SurfaceGraph graph, const Eigen::Matrix3d& rotation, double scale, const Vec3& shift) {
  for (Vec3& p : graph.position) p = scale * (rotation * p) + shift;
  for (Vec3& n : graph.normal) n = rotation * n;
  for (double& a : graph.area) a *= scale * scale;
  for (float& w : graph.weight) w *= static_cast<float>(scale * scale);
  graph.mean_edge_length *= scale;
  graph.total_area *= scale * scale;
  return graph;
}

/// n vertices on a line without any edge: isolated.
inline SurfaceGraph isolated(std::size_t n) {
  std::vector<Vec3> positions(n);
  for (std::size_t i = 0; i < n; ++i) positions[i] = Vec3(static_cast<double>(i), 0, 0);
  SurfaceGraph graph = graph_of_edges(std::move(positions), {});
  graph.normal.assign(n, Vec3::Zero());
  graph.area.assign(n, 0.0);
  graph.total_area = 0.0;
  return graph;
}

}  // namespace shapelight::testing
