#pragma once

#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "simplify/manifold_mesh.hpp"
#include "simplify/quadric.hpp"

namespace shapelight::simplification {

/// A manifold mesh for edge collapses: no faces and no half-edges, only the ordered neighbours ("ring") of every
/// vertex, in one arena. Vertices are numbered along a Morton curve and one collapse touches one neighbourhood, so
/// most of what it reads is in the cache. Coordinates are in a box of size 1 about the origin.
template <class Scalar>
class CollapseMesh {
 public:
  using Vector = typename Quadric<Scalar>::Vector;

  /// What is read of many neighbours at a time: one vector register.
  struct alignas(4 * sizeof(Scalar)) Point {
    Scalar x, y, z;
    Scalar error;  ///< the vertex's own quadric at its own position

    [[nodiscard]] Vector position() const { return {x, y, z}; }
  };

  enum Flag : std::uint16_t {
    kOpen = 1,    ///< on the border: the ring does not close
    kLine = 2,    ///< on a line: collapses along it only
    kLocked = 4,  ///< stays
    kMoved = 8    ///< no longer at its input position
  };

  /// What is read of one vertex at a time: one cache line.
  struct alignas(64) Vertex {
    Quadric<Scalar> quadric;
    Index ring, size, capacity;  ///< neighbours are arena[ring, ring + size), counter-clockwise; size 0: dead
    float key;                   ///< cost of the cheapest collapse as far as known
    Index target;                ///< into this neighbour
    std::uint16_t flags = 0;
    std::uint16_t unused;
    std::uint32_t stamp;  ///< when the vertex became what it is
    [[nodiscard]] bool is(Flag flag) const { return (flags & flag) != 0; }
    void set(Flag flag, bool on = true) { flags = static_cast<std::uint16_t>(on ? flags | flag : flags & ~flag); }
    [[nodiscard]] bool is_dead() const { return size == 0; }
  };

  CollapseMesh(const ManifoldMesh& mesh, double boundary_weight, const RunContext& context);

  [[nodiscard]] Index size() const { return static_cast<Index>(vertices_.size()); }
  [[nodiscard]] std::size_t num_live() const { return num_live_; }
  [[nodiscard]] std::size_t num_faces() const { return num_faces_; }
  [[nodiscard]] Vertex& vertex(Index v) { return vertices_[v]; }
  [[nodiscard]] const Vertex& vertex(Index v) const { return vertices_[v]; }
  [[nodiscard]] Point& point(Index v) { return points_[v]; }
  [[nodiscard]] const Point& point(Index v) const { return points_[v]; }
  /// See ManifoldMesh::junction.
  [[nodiscard]] Index junction(Index v) const { return junction_.empty() ? kNoIndex : junction_[v]; }
  [[nodiscard]] std::span<const Index> ring(Index v) const {
    return {arena_.data() + vertices_[v].ring, vertices_[v].size};
  }
  /// Is v one of the two neighbours of u along its line?
  [[nodiscard]] bool is_next_on_line(Index u, Index v) const { return lines_[u][0] == v || lines_[u][1] == v; }
  /// Vertex of the mesh given to the constructor.
  [[nodiscard]] Index original(Index v) const { return order_[v]; }

  /// May u be removed into its neighbour v without a change of topology? (Dey et al. 1999: the link condition.)
  [[nodiscard]] bool keeps_topology(Index u, Index v) const;
  /// Does no face of u turn over or become a sliver when u moves to p, leaving the faces of `other` aside?
  [[nodiscard]] bool keeps_faces(Index u, Index other, const Vector& p, bool slivers) const;

  struct Wing {
    std::span<const Index> gained;  ///< new neighbours of v; valid until the next call
    std::array<Index, 2> opposite;  ///< the third vertices of the removed faces; the second kNoIndex at a border
  };
  /// Removes u into v. Pre: keeps_topology(u, v). Leaves positions and quadrics alone.
  Wing collapse(Index u, Index v);

  /// Room for a ring of this size: whole blocks of four, unused places hold kNoIndex.
  [[nodiscard]] static Index padded(std::size_t size) { return static_cast<Index>((size + 3) / 4 * 4); }

  /// Fetch ahead: the vertex, its ring (once the vertex is there), its neighbours' points (once the ring is there).
  void prefetch_vertex(Index v) const { __builtin_prefetch(&vertices_[v]); }
  void prefetch_ring(Index v) const {
    __builtin_prefetch(&arena_[vertices_[v].ring]);
    __builtin_prefetch(&points_[v]);
  }
  void prefetch_neighbors(Index v) const {
    for (const Index w : ring(v)) __builtin_prefetch(&points_[w]);
  }

  /// The live mesh, with the vertices in the order they came in. Vertices that moved get their new positions.
  [[nodiscard]] ManifoldMesh finish(ManifoldMesh&& input, const RunContext& context) const;

 private:
  [[nodiscard]] bool meets_another_copy(Index u, Index v) const;
  void sort_along_curve(std::span<const Vec3> positions, const RunContext& context);
  void add_quadrics(Index v, Scalar boundary_weight);
  void replace(Index v, Index old_neighbor, Index new_neighbor);
  void remove(Index v, Index neighbor);
  void store_ring(Index v, Index u, std::span<const Index> ring);
  void relink_line(Index u, Index v);

  std::vector<Point> points_;
  std::vector<Vertex> vertices_;
  std::vector<Index> arena_;
  std::vector<std::array<Index, 2>> lines_;
  std::vector<Index> order_;  // vertex -> input vertex
  std::vector<Index> junction_;
  std::vector<Index> merged_, gained_;
  std::size_t num_live_ = 0, num_faces_ = 0;
  Vec3 center_ = Vec3::Zero();
  double scale_ = 1.0;
};

}  // namespace shapelight::simplification
