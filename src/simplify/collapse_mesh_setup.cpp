#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "simplify/collapse_mesh.hpp"
#include "simplify/morton_order.hpp"
#include "simplify/wedges.hpp"

namespace shapelight::simplification {

template <class Scalar>
CollapseMesh<Scalar>::CollapseMesh(const ManifoldMesh& mesh, double boundary_weight, const RunContext& context) {
  const auto& positions = mesh.mesh.positions;
  const auto& triangles = mesh.mesh.triangles;
  const std::size_t n = positions.size();
  num_live_ = n;
  num_faces_ = triangles.size();
  sort_along_curve(positions, context);
  std::vector<Index> rank(n);
  for (Index v = 0; v < n; ++v) rank[order_[v]] = v;

  std::vector<Triangle> renumbered(triangles.size());
  parallel::for_chunks(context, triangles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      for (std::size_t c = 0; c < 3; ++c) renumbered[f][c] = rank[triangles[f][c]];
    }
  });
  Wedges wedges = collect_wedges(n, renumbered, context);

  context.check();
  vertices_.resize(n);
  lines_.assign(n, {kNoIndex, kNoIndex});
  constexpr Index kLeastCapacity = 8;  // most rings grow by two in their first merger
  Index used = 0;
  for (std::size_t v = 0; v < n; ++v) {
    poll(context, v);
    vertices_[v].ring = used;
    vertices_[v].capacity = std::max(padded(wedges.at(v).size() + 1), kLeastCapacity);
    used += vertices_[v].capacity;
  }
  for (const Index v : order_) {
    if (!mesh.junction.empty()) junction_.push_back(mesh.junction[v]);
  }
  context.check();
  arena_.reserve(used + used / 4);
  arena_.resize(used, kNoIndex);
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vertex& vertex = vertices_[v];
      const auto fan = wedges.at(v);
      const bool open = order_fan(fan) == Fan::Open;
      Index* ring = arena_.data() + vertex.ring;
      for (const Wedge& wedge : fan) *ring++ = wedge.next;
      if (open) *ring = fan.back().previous;
      vertex.size = static_cast<Index>(fan.size() + (open ? 1 : 0));
      const auto& line = mesh.line[order_[v]];
      if (line[0] != kNoIndex) lines_[v] = {rank[line[0]], rank[line[1]]};
      vertex.set(kOpen, open);
      vertex.set(kLine, line[0] != kNoIndex);
      vertex.set(kLocked, mesh.locked[order_[v]] != 0);
      vertex.stamp = 0;
      vertex.target = kNoIndex;
      add_quadrics(static_cast<Index>(v), static_cast<Scalar>(boundary_weight));
    }
  });
}

template <class Scalar>
void CollapseMesh<Scalar>::sort_along_curve(std::span<const Vec3> positions, const RunContext& context) {
  if (positions.empty()) return;
  Vec3 low = positions[0], high = positions[0];
  for (const Vec3& p : positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double extent = (high - low).maxCoeff();
  scale_ = extent > 0.0 ? 1.0 / extent : 1.0;
  center_ = 0.5 * (low + high);
  order_ = morton_order(positions, low, scale_, context);
  points_.resize(positions.size());
  parallel::for_chunks(context, positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      // Rounded, so that ties break the same way wherever the mesh lies.
      const Eigen::Vector3f p = (scale_ * (positions[order_[v]] - center_)).template cast<float>();
      points_[v] = {p.x(), p.y(), p.z(), 0};
    }
  });
}

// Planes of the faces times their area; along lines planes through the edge, square to its faces, times its length
// squared. All of them pass through the vertex.
template <class Scalar>
void CollapseMesh<Scalar>::add_quadrics(Index v, Scalar boundary_weight) {
  Vertex& vertex = vertices_[v];
  vertex.quadric = {};
  const auto around = ring(v);
  const Vector p = points_[v].position();
  for (std::size_t i = vertex.is(kOpen) ? 1 : 0; i < around.size(); ++i) {
    const Index wa = around[i == 0 ? around.size() - 1 : i - 1], wb = around[i];
    const Vector a = points_[wa].position() - p, b = points_[wb].position() - p;
    const Vector normal = a.cross(b);
    const Scalar length = normal.norm();  // twice the area
    if (!(length > 0)) continue;
    vertex.quadric.add_plane(normal, Scalar(0.5) / length);
    if (!vertex.is(kLine)) continue;
    for (const Index w : lines_[v]) {
      if (w != wa && w != wb) continue;
      const Vector edge = w == wa ? a : b;
      vertex.quadric.add_plane(edge.cross(normal) / length, boundary_weight);
    }
  }
}

template <class Scalar>
ManifoldMesh CollapseMesh<Scalar>::finish(ManifoldMesh&& input, const RunContext& context) const {
  const std::size_t n = vertices_.size();
  std::vector<Index> number(n);  // live vertices in the order of the input: first by input vertex, then by our own
  for (Index v = 0; v < n; ++v) number[order_[v]] = v;
  std::vector<Index> kept;
  kept.reserve(num_live_);
  for (Index i = 0; i < n; ++i) {
    if (!vertices_[number[i]].is_dead()) kept.push_back(number[i]);
  }
  for (Index i = 0; i < kept.size(); ++i) number[kept[i]] = i;

  ManifoldMesh result;
  result.source.resize(kept.size());
  result.locked.resize(kept.size());
  result.junction.resize(input.junction.empty() ? 0 : kept.size());
  result.line.resize(kept.size());
  result.mesh.positions.resize(kept.size());
  parallel::for_chunks(context, kept.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index v = kept[i], from = order_[v];
      result.source[i] = input.source[from];
      result.locked[i] = input.locked[from];
      if (!result.junction.empty()) result.junction[i] = input.junction[from];
      result.line[i] = lines_[v];
      if (lines_[v][0] != kNoIndex) result.line[i] = {number[lines_[v][0]], number[lines_[v][1]]};
      result.mesh.positions[i] = input.mesh.positions[from];
      if (vertices_[v].is(kMoved)) {
        result.mesh.positions[i] = center_ + points_[v].position().template cast<double>() / scale_;
      }
    }
  });
  result.mesh.triangles.reserve(num_faces_);
  for (Index v = 0; v < n; ++v) {
    poll(context, v);
    if (vertices_[v].is_dead()) continue;
    const auto around = ring(v);
    for (std::size_t i = vertices_[v].is(kOpen) ? 1 : 0; i < around.size(); ++i) {
      const Index a = around[i == 0 ? around.size() - 1 : i - 1], b = around[i];
      // Each face once: at the smallest of its vertices.
      if (v < a && v < b) result.mesh.triangles.push_back({number[v], number[a], number[b]});
    }
  }
  return result;
}

template CollapseMesh<float>::CollapseMesh(const ManifoldMesh&, double, const RunContext&);
template CollapseMesh<double>::CollapseMesh(const ManifoldMesh&, double, const RunContext&);
template ManifoldMesh CollapseMesh<float>::finish(ManifoldMesh&&, const RunContext&) const;
template ManifoldMesh CollapseMesh<double>::finish(ManifoldMesh&&, const RunContext&) const;

}  // namespace shapelight::simplification
