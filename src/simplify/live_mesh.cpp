#include "simplify/live_mesh.hpp"

#include <algorithm>
#include <utility>

namespace shapelight::simplification {
namespace {

bool has_corner(const Triangle& t, Index v) { return t[0] == v || t[1] == v || t[2] == v; }

// The corner of the triangle that is neither a nor b.
Index opposite(const Triangle& t, Index a, Index b) {
  for (const Index v : t) {
    if (v != a && v != b) return v;
  }
  return kNoIndex;
}

Index after(const Triangle& t, Index v) { return t[0] == v ? t[1] : t[1] == v ? t[2] : t[0]; }

}  // namespace

StarTable::StarTable(std::size_t num_vertices, std::span<const Triangle> triangles) : slot_(num_vertices) {
  for (const Triangle& t : triangles) {
    for (const Index v : t) ++slot_[v].capacity;
  }
  std::size_t end = 0;
  for (Slot& slot : slot_) {
    slot.begin = end;
    end += slot.capacity;
  }
  arena_.resize(end);
  for (Index f = 0; f < triangles.size(); ++f) {
    for (const Index v : triangles[f]) arena_[slot_[v].begin + slot_[v].size++] = f;
  }
}

void StarTable::add(Index v, Index face) {
  Slot& slot = slot_[v];
  if (slot.size == slot.capacity) {  // moves to the end of the arena; its old place stays unused
    const std::size_t old = std::exchange(slot.begin, arena_.size());
    slot.capacity = 2 * slot.capacity + 4;
    arena_.resize(arena_.size() + slot.capacity);
    std::copy_n(arena_.begin() + static_cast<std::ptrdiff_t>(old), slot.size,
                arena_.begin() + static_cast<std::ptrdiff_t>(slot.begin));
  }
  arena_[slot.begin + slot.size++] = face;
}

void StarTable::remove(Index v, Index face) {
  Slot& slot = slot_[v];
  const auto begin = arena_.begin() + static_cast<std::ptrdiff_t>(slot.begin);
  slot.size = static_cast<std::uint32_t>(std::remove(begin, begin + slot.size, face) - begin);
}

LiveMesh::LiveMesh(ManifoldMesh&& mesh)
    : position(std::move(mesh.mesh.positions)),
      source(std::move(mesh.source)),
      locked(std::move(mesh.locked)),
      junction(std::move(mesh.junction)),
      face_(std::move(mesh.mesh.triangles)),
      stars_(position.size(), face_),
      line_edges_(position.size(), {kNoIndex, kNoIndex}),
      live_vertices_(position.size()),
      live_faces_(face_.size()) {
  const auto attach = [&](Index v, Index edge) {
    if (mesh.line[v][0] == kNoIndex) return;
    line_edges_[v][line_edges_[v][0] == kNoIndex ? 0 : 1] = edge;
  };
  for (Index v = 0; v < position.size(); ++v) {
    for (const Index w : mesh.line[v]) {
      if (w == kNoIndex || (mesh.line[w][0] != kNoIndex && w < v)) continue;
      const Index edge = static_cast<Index>(line_ends_.size());
      line_ends_.push_back({v, w});
      attach(v, edge);
      attach(w, edge);
    }
  }
}

void LiveMesh::neighbors(Index v, std::vector<Index>& out) const {
  out.clear();
  for (const Index f : stars_[v]) {
    for (const Index w : face_[f]) {
      if (w != v && std::find(out.begin(), out.end(), w) == out.end()) out.push_back(w);
    }
  }
}

std::array<Index, 2> LiveMesh::faces_at_edge(Index a, Index b) const {
  std::array<Index, 2> found{kNoIndex, kNoIndex};
  for (const Index f : stars_[a]) {
    if (has_corner(face_[f], b)) found[found[0] == kNoIndex ? 0 : 1] = f;
  }
  return found;
}

bool LiveMesh::is_line_edge(Index a, Index b) const {
  for (const Index edge : line_edges_[a]) {
    if (edge != kNoIndex && other_end(edge, a) == b) return true;
  }
  for (const Index edge : line_edges_[b]) {
    if (edge != kNoIndex && other_end(edge, b) == a) return true;
  }
  return locked[a] && locked[b];  // two junctions may be joined by a line of one edge
}

bool LiveMesh::may_lose_face(Index v) const {
  const std::size_t faces = stars_[v].size();
  if (faces != 2 && faces != 3) return faces > 3;
  return std::any_of(stars_[v].begin(), stars_[v].end(), [&](Index f) {  // on a border
    return faces_at_edge(v, after(face_[f], v))[1] == kNoIndex;
  });
}

bool LiveMesh::meets_another_copy(Index v, Index w, Index removed) const {
  if (junction.empty() || (junction[v] == kNoIndex && junction[w] == kNoIndex)) return false;
  if (junction[v] != kNoIndex && junction[w] != kNoIndex) return true;  // another sheet may have that edge
  return junction[v] != kNoIndex ? has_copy_near(w, v, removed) : has_copy_near(v, w, removed);
}

bool LiveMesh::has_copy_near(Index v, Index copied, Index removed) const {
  for (const Index f : stars_[v]) {
    for (const Index x : face_[f]) {
      if (x != copied && x != removed && junction[x] == junction[copied]) return true;
    }
  }
  return false;
}

bool LiveMesh::may_collapse(Index u, Index v) const {
  if (locked[u]) return false;
  if (is_on_line(u)) {
    const bool first = other_end(line_edges_[u][0], u) == v;
    if (!first && other_end(line_edges_[u][1], u) != v) return false;
    const Index far = other_end(line_edges_[u][first ? 1 : 0], u);
    if (far == v || is_line_edge(far, v)) return false;  // the line would fold onto itself
  }
  const std::array<Index, 2> shared = faces_at_edge(u, v);
  std::array<Index, 2> apex{kNoIndex, kNoIndex};
  for (int i = 0; i < 2; ++i) {
    if (shared[i] == kNoIndex) continue;
    apex[i] = opposite(face_[shared[i]], u, v);
    if (!may_lose_face(apex[i])) return false;
  }
  for (const Index f : stars_[u]) {  // link condition: no common neighbour but the apexes
    for (const Index w : face_[f]) {
      if (w == u || w == v) continue;
      if (meets_another_copy(v, w, u)) return false;
      if (!junction.empty() && junction[w] != kNoIndex && has_copy_near(u, w, kNoIndex)) return false;
      if (w == apex[0] || w == apex[1]) continue;
      if (faces_at_edge(w, v)[0] != kNoIndex) return false;
    }
  }
  return true;
}

void LiveMesh::collapse(Index u, Index v) {
  const auto kill = [&](Index f) {
    for (const Index w : face_[f]) {
      if (w != u) stars_.remove(w, f);
    }
    face_[f] = {kNoIndex, kNoIndex, kNoIndex};
    --live_faces_;
  };
  const std::span<const Index> star = stars_[u];
  const std::vector<Index> faces(star.begin(), star.end());
  for (const Index f : faces) {
    if (has_corner(face_[f], v)) {
      kill(f);
    } else {
      std::replace(face_[f].begin(), face_[f].end(), u, v);
      stars_.add(v, f);
    }
  }
  stars_.clear(u);
  --live_vertices_;
  if (!is_on_line(u)) return;
  const bool first = other_end(line_edges_[u][0], u) == v;
  const Index kept = line_edges_[u][first ? 0 : 1];
  const Index gone = line_edges_[u][first ? 1 : 0];
  const Index far = other_end(gone, u);
  std::replace(line_ends_[kept].begin(), line_ends_[kept].end(), u, far);
  std::replace(line_edges_[far].begin(), line_edges_[far].end(), gone, kept);
  line_edges_[u] = {kNoIndex, kNoIndex};
}

bool LiveMesh::may_flip(Index f, Index g, std::array<Index, 4>& quad) const {
  const Triangle& t = face_[f];
  for (int i = 0; i < 3; ++i) {
    const Index a = t[i];
    const Index b = t[(i + 1) % 3];
    if (!has_corner(face_[g], a) || !has_corner(face_[g], b)) continue;
    const Index c = t[(i + 2) % 3];
    const Index d = opposite(face_[g], a, b);
    if (c == d || is_line_edge(a, b) || faces_at_edge(c, d)[0] != kNoIndex) return false;
    if (meets_another_copy(a, b, kNoIndex) || meets_another_copy(c, d, kNoIndex)) return false;
    if (!may_lose_face(a) || !may_lose_face(b)) return false;
    quad = {a, b, c, d};
    return true;
  }
  return false;
}

void LiveMesh::flip(Index f, Index g, const std::array<Index, 4>& quad) {
  const auto [a, b, c, d] = quad;
  face_[f] = {c, d, b};
  face_[g] = {d, c, a};
  stars_.remove(a, f);
  stars_.remove(b, g);
  stars_.add(d, f);
  stars_.add(c, g);
}

ManifoldMesh LiveMesh::compact() && {
  ManifoldMesh out;
  std::vector<Index> renumbered(position.size(), kNoIndex);
  for (Index v = 0; v < position.size(); ++v) {
    if (!is_alive(v)) continue;
    renumbered[v] = static_cast<Index>(out.mesh.positions.size());
    out.mesh.positions.push_back(position[v]);
    out.source.push_back(source[v]);
    out.locked.push_back(locked[v]);
    if (!junction.empty()) out.junction.push_back(junction[v]);
  }
  out.line.resize(out.source.size(), {kNoIndex, kNoIndex});
  for (Index v = 0; v < position.size(); ++v) {
    if (renumbered[v] == kNoIndex || !is_on_line(v)) continue;
    for (int i = 0; i < 2; ++i) out.line[renumbered[v]][i] = renumbered[other_end(line_edges_[v][i], v)];
  }
  for (const Triangle& t : face_) {
    if (t[0] != kNoIndex) out.mesh.triangles.push_back({renumbered[t[0]], renumbered[t[1]], renumbered[t[2]]});
  }
  return out;
}

}  // namespace shapelight::simplification
