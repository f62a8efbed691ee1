#include "simplify/star_shape.hpp"

#include <algorithm>
#include <cmath>

#include "core/poll.hpp"

namespace shapelight::simplification {

namespace {

// The mesh with u in the place of v: every face that holds both is gone.
class MergedMesh {
 public:
  MergedMesh(const LiveMesh& mesh, Index u, Index v) : mesh_(mesh), u_(u), v_(v) {}

  [[nodiscard]] bool has(Index f) const { return f != kNoIndex && !(u_ != v_ && holds(f, u_) && holds(f, v_)); }

  [[nodiscard]] bool is_folded(Index f, Index g) const {
    const Vec3 n = cross(f), m = cross(g);
    const double dot = n.dot(m);
    return dot < 0.0 && dot < kFolded * std::sqrt(n.squaredNorm() * m.squaredNorm());
  }

  // Is there a neighbour, and are all folded?
  [[nodiscard]] bool is_turned(Index f) const {
    const Triangle& t = mesh_.face(f);
    bool turned = false;
    for (int k = 0; k < 3; ++k) {
      for (const Index a : {t[k], twin(t[k])}) {
        for (const Index b : {t[(k + 1) % 3], twin(t[(k + 1) % 3])}) {
          for (const Index g : mesh_.faces_at_edge(a, b)) {
            if (g == f || !has(g)) continue;
            if (!is_folded(f, g)) return false;
            turned = true;
          }
        }
      }
    }
    return turned;
  }

 private:
  [[nodiscard]] bool holds(Index f, Index v) const {
    const Triangle& t = mesh_.face(f);
    return t[0] == v || t[1] == v || t[2] == v;
  }
  [[nodiscard]] Index twin(Index w) const { return w == u_ ? v_ : w == v_ ? u_ : w; }
  [[nodiscard]] Vec3 cross(Index f) const {
    const auto corner = [&](int k) -> const Vec3& {
      const Index w = mesh_.face(f)[k];
      return mesh_.position[w == u_ ? v_ : w];
    };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }

  const LiveMesh& mesh_;
  Index u_, v_;
};

}  // namespace

LocalTriangle triangle_with(const LiveMesh& mesh, Index face, Index v, const Vec3& place, const Vec3& origin) {
  const Triangle& t = mesh.face(face);
  const auto corner = [&](int k) -> Vec3 { return (t[k] == v ? place : mesh.position[t[k]]) - origin; };
  return {corner(0), corner(1), corner(2)};
}

bool StarShape::keeps_shape(const Vec3& before, const LocalTriangle& after, double worst, const ShapeLimits& limits) {
  if (after.double_area <= 0.0) return false;
  if (before != Vec3::Zero() && before.dot(after.normal) < limits.min_cosine) return false;
  return after.quality() >= std::min(limits.min_quality, worst);
}

void StarShape::measure(const LiveMesh& mesh, Index v) {
  normal.clear();
  worst_quality = 1.0;
  const Vec3& p = mesh.position[v];
  for (const Index f : mesh.star(v)) {
    const LocalTriangle t = triangle_with(mesh, f, v, p, p);
    normal.push_back(t.normal);
    worst_quality = std::min(worst_quality, t.quality());
  }
}

bool folds_faces(const LiveMesh& mesh, Index u, Index v) {
  const MergedMesh merged(mesh, u, v);
  for (const Index center : {u, v}) {
    for (const Index f : mesh.star(center)) {
      if (!merged.has(f)) continue;
      const Triangle& t = mesh.face(f);
      const int k = t[0] == center ? 0 : t[1] == center ? 1 : 2;
      const std::array<Index, 2> sides = mesh.faces_at_edge(t[(k + 1) % 3], t[(k + 2) % 3]);
      const Index outside = sides[0] == f ? sides[1] : sides[0];
      const bool has_outside = merged.has(outside);
      if (has_outside && !merged.is_folded(f, outside)) continue;  // almost always; clears both
      if (merged.is_turned(f) || (has_outside && merged.is_turned(outside))) return true;
    }
    if (u == v) break;
  }
  return false;
}

std::vector<std::vector<Index>> independent_classes(const LiveMesh& mesh, std::span<const Index> vertices,
                                                    const RunContext& context) {
  constexpr int kMaxClasses = 64;
  std::vector<std::vector<Index>> classes;
  std::vector<std::int8_t> class_of(mesh.num_vertices(), -1);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    poll(context, i);
    const Index v = vertices[i];
    std::uint64_t taken = 0;
    for (const Index f : mesh.star(v)) {
      for (const Index w : mesh.face(f)) {
        if (class_of[w] >= 0) taken |= std::uint64_t{1} << class_of[w];
      }
    }
    int chosen = 0;
    while (chosen < kMaxClasses && (taken >> chosen & 1U) != 0) ++chosen;
    if (chosen == kMaxClasses) continue;  // a vertex with that many kinds of neighbours waits for the next round
    class_of[v] = static_cast<std::int8_t>(chosen);
    if (static_cast<std::size_t>(chosen) == classes.size()) classes.emplace_back();
    classes[chosen].push_back(v);
  }
  return classes;
}

}  // namespace shapelight::simplification
