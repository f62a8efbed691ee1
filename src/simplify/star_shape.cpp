#include "simplify/star_shape.hpp"

#include <algorithm>

namespace shapelight::simplification {

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

std::vector<std::vector<Index>> independent_classes(const LiveMesh& mesh, std::span<const Index> vertices) {
  constexpr int kMaxClasses = 64;
  std::vector<std::vector<Index>> classes;
  std::vector<std::int8_t> class_of(mesh.num_vertices(), -1);
  for (const Index v : vertices) {
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
