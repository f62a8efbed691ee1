#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "shapelight/data/geometry.hpp"

namespace shapelight::bench {

/// The mesh with every triangle cut into parts x parts, welded along the old edges, and all points shifted by a smooth
/// wave, small against the edges, so that no part of the finer mesh is flat.
inline Geometry finer_mesh(const Geometry& mesh, Index parts) {
  Geometry fine;
  fine.positions = mesh.positions;
  std::map<std::array<Index, 3>, Index> on_edge;  // edge and step from its lower end
  const auto new_point = [&](const Vec3& p) {
    fine.positions.push_back(p);
    return static_cast<Index>(fine.positions.size() - 1);
  };
  const auto on_line = [&](Index a, Index b, Index step) {  // `step` parts from a to b
    if (step == 0) return a;
    if (step == parts) return b;
    if (b < a) {
      std::swap(a, b);
      step = parts - step;
    }
    const auto [found, is_new] = on_edge.try_emplace({a, b, step}, kNoIndex);
    if (is_new) {
      const double t = static_cast<double>(step) / parts;
      found->second = new_point((1.0 - t) * mesh.positions[a] + t * mesh.positions[b]);
    }
    return found->second;
  };
  std::vector<Index> row, next;
  for (const auto& [a, b, c] : mesh.triangles) {
    next = {a};
    for (Index r = 1; r <= parts; ++r) {
      row.swap(next);
      const Index left = on_line(a, b, r), right = on_line(a, c, r);
      next = {left};
      for (Index i = 1; i < r; ++i) {
        const double t = static_cast<double>(i) / r;
        next.push_back(r == parts ? on_line(b, c, i)
                                  : new_point((1.0 - t) * fine.positions[left] + t * fine.positions[right]));
      }
      next.push_back(right);
      for (Index i = 0; i < r; ++i) {
        fine.triangles.push_back({row[i], next[i], next[i + 1]});
        if (i + 1 < r) fine.triangles.push_back({row[i], next[i + 1], row[i + 1]});
      }
    }
  }
  const double diagonal = bounding_box(fine.positions).diagonal();
  for (Vec3& p : fine.positions) {
    const Vec3 phase = p * (400.0 / diagonal);
    p += 1e-4 * diagonal * Vec3(std::sin(phase.y()), std::sin(phase.z()), std::sin(phase.x()));
  }
  return fine;
}

}  // namespace shapelight::bench
