#pragma once

#include "simplify/live_mesh.hpp"
#include "simplify/sample_block.hpp"

namespace shapelight::simplify {

/// The face with corner v at `place` in place of where v is, relative to `origin`.
[[nodiscard]] LocalTriangle triangle_with(const LiveMesh& mesh, Index face, Index v, const Vec3& place,
                                          const Vec3& origin);

/// How much a face may turn in one step, and how thin it may get, unless its star was as thin before.
struct ShapeLimits {
  double min_cosine = 0.2;
  double min_quality = 0.01;
};

/// Does a face keep its side and shape when `before` becomes `after`? `worst_before`: least quality of the faces at
/// hand.
[[nodiscard]] bool keeps_shape(const LocalTriangle& before, const LocalTriangle& after, double worst_before,
                               const ShapeLimits& limits);

/// Least quality of the faces around v.
[[nodiscard]] double worst_quality(const LiveMesh& mesh, Index v);

/// Splits vertices into classes of which no two members are neighbours: those of a class can be worked on at once.
/// Greedy in the order given; classes keep that order.
[[nodiscard]] std::vector<std::vector<Index>> independent_classes(const LiveMesh& mesh,
                                                                  std::span<const Index> vertices);

}  // namespace shapelight::simplify
