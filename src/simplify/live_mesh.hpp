#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "simplify/manifold_mesh.hpp"

namespace shapelight::simplification {

/// The faces around every vertex, unordered, in one arena.
class StarTable {
 public:
  StarTable(std::size_t num_vertices, std::span<const Triangle> triangles);
  [[nodiscard]] std::span<const Index> operator[](Index v) const {
    return {arena_.data() + slot_[v].begin, slot_[v].size};
  }
  void add(Index v, Index face);
  void remove(Index v, Index face);
  void clear(Index v) { slot_[v].size = 0; }

 private:
  struct Slot {
    std::size_t begin = 0;
    std::uint32_t size = 0;
    std::uint32_t capacity = 0;
  };
  std::vector<Slot> slot_;
  std::vector<Index> arena_;
};

/// A manifold mesh under change: collapses and flips, with the lines (borders, feature edges) that they must respect.
class LiveMesh {
 public:
  explicit LiveMesh(ManifoldMesh&& mesh);

  std::vector<Vec3> position;
  std::vector<Index> source;  ///< per vertex: input vertex
  std::vector<std::uint8_t> locked;
  std::vector<Index> junction;  ///< see ManifoldMesh

  [[nodiscard]] std::size_t num_vertices() const { return position.size(); }  ///< dead ones included
  [[nodiscard]] std::size_t num_faces() const { return face_.size(); }        ///< dead ones included
  [[nodiscard]] std::size_t num_live_vertices() const { return live_vertices_; }
  [[nodiscard]] std::size_t num_live_faces() const { return live_faces_; }
  [[nodiscard]] const Triangle& face(Index f) const { return face_[f]; }
  [[nodiscard]] bool is_face_alive(Index f) const { return face_[f][0] != kNoIndex; }
  [[nodiscard]] bool is_alive(Index v) const { return !stars_[v].empty(); }
  [[nodiscard]] std::span<const Index> star(Index v) const { return stars_[v]; }

  /// Vertices that share an edge with v, each once.
  void neighbors(Index v, std::vector<Index>& out) const;
  /// Faces that hold both a and b.
  [[nodiscard]] std::array<Index, 2> faces_at_edge(Index a, Index b) const;

  [[nodiscard]] bool is_on_line(Index v) const { return line_edges_[v][0] != kNoIndex; }
  [[nodiscard]] bool is_line_edge(Index a, Index b) const;
  [[nodiscard]] const std::array<Index, 2>& line_edges(Index v) const { return line_edges_[v]; }
  [[nodiscard]] const std::array<Index, 2>& line_ends(Index edge) const { return line_ends_[edge]; }
  [[nodiscard]] std::size_t num_line_edges() const { return line_ends_.size(); }
  [[nodiscard]] Index other_end(Index edge, Index v) const {
    return line_ends_[edge][0] == v ? line_ends_[edge][1] : line_ends_[edge][0];
  }

  /// May u be removed into its neighbour v without changing the topology, and along its line if it is on one?
  [[nodiscard]] bool may_collapse(Index u, Index v) const;
  /// u becomes v. Pre: may_collapse(u, v). On a line, the edge (u, v) takes over what u's other line edge spanned.
  void collapse(Index u, Index v);

  /// May the edge between these faces be exchanged for the other diagonal? `quad` gets {a, b, c, d}: f = (a, b, c), g =
  /// (b, a, d).
  [[nodiscard]] bool may_flip(Index f, Index g, std::array<Index, 4>& quad) const;
  /// The faces become (c, d, b) and (d, c, a). Pre: may_flip().
  void flip(Index f, Index g, const std::array<Index, 4>& quad);

  /// The living part, renumbered in order.
  [[nodiscard]] ManifoldMesh compact() &&;

 private:
  /// Would one face less leave v a fan, of two faces in the inside of the surface at least and of one on its border?
  [[nodiscard]] bool may_lose_face(Index v) const;

  /// Would an edge from v to w exist twice, once the copies of every junction are one?
  [[nodiscard]] bool meets_another_copy(Index v, Index w, Index removed) const;
  [[nodiscard]] bool has_copy_near(Index v, Index copied, Index removed) const;

  std::vector<Triangle> face_;
  StarTable stars_;
  std::vector<std::array<Index, 2>> line_edges_;  ///< per vertex: its two line edges; kNoIndex twice off lines
  std::vector<std::array<Index, 2>> line_ends_;   ///< per line edge
  std::size_t live_vertices_ = 0;
  std::size_t live_faces_ = 0;
};

}  // namespace shapelight::simplification
