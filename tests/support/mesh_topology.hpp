#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "shapelight/data/triangle_mesh.hpp"

/// Slow and plain counts of what a mesh is, as oracles.
namespace shapelight::testing {

using DirectedEdge = std::pair<Index, Index>;

/// Faces per directed edge.
inline std::map<DirectedEdge, int> directed_edges(std::span<const Triangle> triangles) {
  std::map<DirectedEdge, int> edges;
  for (const Triangle& t : triangles) {
    for (int c = 0; c < 3; ++c) ++edges[{t[c], t[(c + 1) % 3]}];
  }
  return edges;
}

struct Topology {
  bool is_manifold = true;  ///< every edge has one face or two that disagree on its direction; one fan per vertex
  std::size_t vertices = 0, edges = 0, faces = 0, border_edges = 0, border_loops = 0, components = 0;
  std::size_t repeated_faces = 0;  ///< faces over the same three vertices as an earlier one
  [[nodiscard]] long euler() const {
    return static_cast<long>(vertices) - static_cast<long>(edges) + static_cast<long>(faces);
  }
};

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), Index{0}); }
  Index find(Index a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(Index a, Index b) { parent_[find(a)] = find(b); }

 private:
  std::vector<Index> parent_;
};

/// Do the faces at vertex v, joined across their edges at v, form one piece?
inline bool is_one_fan(Index v, const std::vector<Triangle>& faces) {
  DisjointSets sets(faces.size());
  for (Index i = 0; i < faces.size(); ++i) {
    for (Index j = 0; j < i; ++j) {
      for (const Index a : faces[i]) {
        if (a != v && std::ranges::count(faces[j], a) != 0) sets.join(i, j);
      }
    }
  }
  for (Index i = 1; i < faces.size(); ++i) {
    if (sets.find(i) != sets.find(0)) return false;
  }
  return true;
}

inline Topology topology(std::span<const Triangle> triangles) {
  Topology t;
  t.faces = triangles.size();
  const auto edges = directed_edges(triangles);
  std::map<Index, std::vector<Triangle>> faces_at;
  std::set<Triangle> seen;
  for (Triangle face : triangles) {
    for (const Index v : face) faces_at[v].push_back(face);
    std::ranges::sort(face);
    t.repeated_faces += !seen.insert(face).second;
    t.is_manifold &= face[0] != face[1] && face[1] != face[2];
  }
  t.vertices = faces_at.size();
  for (const auto& [v, faces] : faces_at) t.is_manifold &= is_one_fan(v, faces);

  const std::size_t n = faces_at.empty() ? 0 : faces_at.rbegin()->first + std::size_t{1};
  DisjointSets pieces(n), loops(n);
  std::set<Index> on_border;
  for (const auto& [edge, count] : edges) {
    const auto [a, b] = edge;
    t.is_manifold &= count == 1;
    pieces.join(a, b);
    const bool is_border = !edges.contains({b, a});
    t.edges += is_border || a < b;
    t.border_edges += is_border;
    if (!is_border) continue;
    loops.join(a, b);
    on_border.insert({a, b});
  }
  std::set<Index> piece_roots, loop_roots;
  for (const auto& [v, faces] : faces_at) piece_roots.insert(pieces.find(v));
  for (const Index v : on_border) loop_roots.insert(loops.find(v));
  t.components = piece_roots.size();
  t.border_loops = loop_roots.size();
  return t;
}

inline Topology topology(const TriangleMesh& mesh) { return topology(mesh.triangles); }

}  // namespace shapelight::testing
