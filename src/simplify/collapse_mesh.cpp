#include "simplify/collapse_mesh.hpp"

#include <algorithm>
#include <cstring>

namespace shapelight::simplification {
namespace {

// A new face is a sliver below this ratio of twice its area to the sum of its squared sides (0.58 when equilateral),
// unless the old face was no better.
constexpr float kSliver = 0.005f;
// Cosine that a face's normal must keep to its old direction: above the noise of single precision.
constexpr float kTurned = 0.01f;
// Pairs of rings above this product of sizes are intersected by sorting.
constexpr std::size_t kLargeRings = 4096;

std::size_t position_in(std::span<const Index> ring, Index v) {
  std::size_t i = 0;
  while (ring[i] != v) ++i;
  return i;
}

std::size_t count_common_of_large(std::span<const Index> a, std::span<const Index> b) {
  std::vector<Index> sorted(a.begin(), a.end());
  std::sort(sorted.begin(), sorted.end());
  std::size_t common = 0;
  for (const Index y : b) common += std::binary_search(sorted.begin(), sorted.end(), y);
  return common;
}

// Rings are padded to whole blocks with kNoIndex, so that four are compared at once.
std::size_t count_common(std::span<const Index> a, std::span<const Index> b) {
  if (a.size() * b.size() > kLargeRings) return count_common_of_large(a, b);
  using Block = Index __attribute__((vector_size(16)));
  Block common{};
  for (std::size_t i = 0; i < b.size(); i += 4) {
    Block block;
    std::memcpy(&block, b.data() + i, sizeof block);
    for (const Index x : a) common -= reinterpret_cast<Block>(block == x);
  }
  return common[0] + common[1] + common[2] + common[3];
}

}  // namespace

// Would the removal of u into v make an edge or a face twice, once the copies of every junction are one?
template <class Scalar>
bool CollapseMesh<Scalar>::meets_another_copy(Index u, Index v) const {
  const auto ring_u = ring(u), ring_v = ring(v);
  const auto has_copy_of = [&](std::span<const Index> around, Index w) {
    return std::any_of(around.begin(), around.end(),
                       [&](Index x) { return x != w && x != u && junction_[x] == junction_[w]; });
  };
  for (std::size_t i = 0; i < ring_u.size(); ++i) {
    const Index w = ring_u[i];
    if (w == v) continue;
    const bool v_joins = junction_[v] != kNoIndex, w_joins = junction_[w] != kNoIndex;
    if (v_joins && w_joins) {
      const bool is_last = i + 1 == ring_u.size();
      const Index next = is_last ? ring_u[0] : ring_u[i + 1];
      const bool has_face = !(is_last && vertices_[u].is(kOpen)) && next != v;
      if (std::find(ring_v.begin(), ring_v.end(), w) == ring_v.end()) return true;
      if (has_face && junction_[next] != kNoIndex) return true;
    }
    if (w_joins && (has_copy_of(ring_v, w) || has_copy_of(ring_u, w) || junction_[w] == junction_[v])) return true;
    if (v_joins && has_copy_of(ring(w), v)) return true;
  }
  return false;
}

template <class Scalar>
bool CollapseMesh<Scalar>::keeps_topology(Index u, Index v) const {
  const auto ring_u = ring(u), ring_v = ring(v);
  const bool u_open = vertices_[u].is(kOpen), v_open = vertices_[v].is(kOpen);
  const std::size_t at = position_in(ring_u, v);
  const bool first = u_open && at == 0, last = u_open && at + 1 == ring_u.size();
  const bool border_edge = first || last;
  // The faces beside the edge go; their third vertices must keep enough faces.
  const auto survives = [&](Index w) { return vertices_[w].size >= (vertices_[w].is(kOpen) ? 3u : 4u); };
  if (!first && !survives(ring_u[at == 0 ? ring_u.size() - 1 : at - 1])) return false;
  if (!last && !survives(ring_u[at + 1 == ring_u.size() ? 0 : at + 1])) return false;
  // An inner edge between two borders would pinch the surface.
  if (u_open && v_open && !border_edge) return false;
  if (u_open && !v_open) return false;
  const std::size_t merged = ring_u.size() + ring_v.size() - (border_edge ? 3 : 4);
  if (merged < (v_open ? 2u : 3u)) return false;
  if (vertices_[u].is(kLine)) {
    // A line needs three edges: its ends must not meet.
    const Index beyond = lines_[u][0] == v ? lines_[u][1] : lines_[u][0];
    if (is_next_on_line(v, beyond) || is_next_on_line(beyond, v)) return false;
    if (border_edge && ring_v.size() < 3) return false;
  }
  if (!junction_.empty() && meets_another_copy(u, v)) return false;
  return count_common(ring_u, ring_v) == (border_edge ? 1u : 2u);
}

template <class Scalar>
bool CollapseMesh<Scalar>::keeps_faces(Index u, Index other, const Vector& p, bool slivers) const {
  const auto around = ring(u);
  const Vector from = points_[u].position();
  const bool open = vertices_[u].is(kOpen);
  for (std::size_t i = open ? 1 : 0; i < around.size(); ++i) {
    const Index wa = around[i == 0 ? around.size() - 1 : i - 1], wb = around[i];
    if (wa == other || wb == other) continue;
    const Vector a = points_[wa].position(), b = points_[wb].position();
    const Vector side = b - a, old_side = a - from, new_side = a - p;
    const Vector old_normal = old_side.cross(side), new_normal = new_side.cross(side);
    const Scalar old_sq = old_normal.squaredNorm(), new_sq = new_normal.squaredNorm();
    if (old_sq == 0) continue;  // had no direction to turn from
    const Scalar dot = old_normal.dot(new_normal);
    if (!(dot > 0) || dot * dot < kTurned * kTurned * old_sq * new_sq) return false;
    if (slivers) continue;
    const Scalar new_sides = new_side.squaredNorm() + side.squaredNorm() + (b - p).squaredNorm();
    if (new_sq < kSliver * kSliver * new_sides * new_sides) {
      const Scalar old_sides = old_side.squaredNorm() + side.squaredNorm() + (b - from).squaredNorm();
      if (new_sq * old_sides * old_sides < old_sq * new_sides * new_sides) return false;
    }
  }
  return true;
}

template <class Scalar>
void CollapseMesh<Scalar>::replace(Index v, Index old_neighbor, Index new_neighbor) {
  Index* slot = arena_.data() + vertices_[v].ring;
  while (*slot != old_neighbor) ++slot;
  *slot = new_neighbor;
}

template <class Scalar>
void CollapseMesh<Scalar>::remove(Index v, Index neighbor) {
  Index* const begin = arena_.data() + vertices_[v].ring;
  Index* const end = begin + vertices_[v].size;
  Index* slot = begin;
  while (*slot != neighbor) ++slot;
  std::copy(slot + 1, end, slot);
  *(end - 1) = kNoIndex;
  --vertices_[v].size;
}

// In v's own place, else in that of u, else at the end with room to grow.
template <class Scalar>
void CollapseMesh<Scalar>::store_ring(Index v, Index u, std::span<const Index> ring) {
  Vertex& kept = vertices_[v];
  if (ring.size() > kept.capacity) {
    if (ring.size() <= vertices_[u].capacity) {
      kept.ring = vertices_[u].ring;
      kept.capacity = vertices_[u].capacity;
    } else {
      kept.ring = static_cast<Index>(arena_.size());
      kept.capacity = padded(ring.size() + ring.size() / 2);
      arena_.resize(arena_.size() + kept.capacity);
    }
  }
  const auto end = std::copy(ring.begin(), ring.end(), arena_.begin() + kept.ring);
  std::fill(end, arena_.begin() + kept.ring + padded(ring.size()), kNoIndex);
  kept.size = static_cast<Index>(ring.size());
}

template <class Scalar>
void CollapseMesh<Scalar>::relink_line(Index u, Index v) {
  const Index beyond = lines_[u][0] == v ? lines_[u][1] : lines_[u][0];
  const auto link = [&](Index w, Index to) {
    for (Index& end : lines_[w]) end = end == u ? to : end;
  };
  link(v, beyond);
  link(beyond, v);
}

template <class Scalar>
typename CollapseMesh<Scalar>::Wing CollapseMesh<Scalar>::collapse(Index u, Index v) {
  const auto ring_u = ring(u), ring_v = ring(v);
  const std::size_t n = ring_u.size(), m = ring_v.size();
  const std::size_t at_v = position_in(ring_u, v), at_u = position_in(ring_v, u);
  const bool u_open = vertices_[u].is(kOpen);
  for (const Index w : ring_u) __builtin_prefetch(arena_.data() + vertices_[w].ring);
  Wing wing{{}, {kNoIndex, kNoIndex}};
  gained_.clear();
  merged_.clear();
  if (u_open && at_v == 0) {
    // u = the last of v's ring; its face (u, v, a) goes and the rest of u's ring follows a.
    wing.opposite[0] = ring_u[1];
    gained_.assign(ring_u.begin() + 2, ring_u.end());
    merged_.assign(ring_v.begin(), ring_v.end() - 1);
    merged_.insert(merged_.end(), gained_.begin(), gained_.end());
  } else if (u_open) {
    wing.opposite[0] = ring_u[n - 2];
    gained_.assign(ring_u.begin(), ring_u.end() - 2);
    merged_.assign(gained_.begin(), gained_.end());
    merged_.insert(merged_.end(), ring_v.begin() + 1, ring_v.end());
  } else {
    // In u's ring v is followed by a and preceded by b; in v's ring u stands between a and b.
    const auto wrap = [n](std::size_t i) { return i < n ? i : i - n; };
    wing.opposite = {ring_u[wrap(at_v + 1)], ring_u[wrap(at_v + n - 1)]};
    for (std::size_t i = 2; i + 1 < n; ++i) gained_.push_back(ring_u[wrap(at_v + i)]);
    merged_.assign(ring_v.begin(), ring_v.begin() + at_u);
    merged_.insert(merged_.end(), gained_.begin(), gained_.end());
    merged_.insert(merged_.end(), ring_v.begin() + at_u + 1, ring_v.begin() + m);
  }
  for (const Index w : gained_) replace(w, u, v);
  remove(wing.opposite[0], u);
  if (wing.opposite[1] != kNoIndex) remove(wing.opposite[1], u);
  if (vertices_[u].is(kLine)) relink_line(u, v);
  store_ring(v, u, merged_);
  vertices_[u].size = 0;
  --num_live_;
  num_faces_ -= wing.opposite[1] != kNoIndex ? 2 : 1;
  wing.gained = gained_;
  return wing;
}

template class CollapseMesh<float>;
template class CollapseMesh<double>;

}  // namespace shapelight::simplification
