#pragma once

#include "simplify/live_mesh.hpp"
#include "simplify/sample_block.hpp"

namespace shapelight::simplification {

/// The face with corner v at `place` in place of where v is, relative to `origin`.
[[nodiscard]] LocalTriangle triangle_with(const LiveMesh& mesh, Index face, Index v, const Vec3& place,
                                          const Vec3& origin);

/// Cosine between the normals of faces that lie on each other. Stricter than the check of the result, which rounds.
inline constexpr double kFolded = -0.89;

/// How much a face may turn in one step, and how thin it may get, unless its star was as thin before.
struct ShapeLimits {
  double min_cosine = 0.2;
  double min_quality = 0.01;
};

/// What the faces around a vertex look like before they change.
struct StarShape {
  std::vector<Vec3> normal;  ///< per face of the star; zero where it has no area
  double worst_quality = 1.0;

  void measure(const LiveMesh& mesh, Index v);
  /// Does the i-th face keep its side and shape when it becomes `after`?
  [[nodiscard]] bool keeps(std::size_t i, const LocalTriangle& after, const ShapeLimits& limits) const {
    return keeps_shape(normal[i], after, worst_quality, limits);
  }
  /// `before` is the normal of a face; `worst`: the least quality of the faces at hand.
  [[nodiscard]] static bool keeps_shape(const Vec3& before, const LocalTriangle& after, double worst,
                                        const ShapeLimits& limits);
};

/// Would removing u into v leave a face around v, or one beside those, folded onto all its neighbours? Such a face has
/// been turned over. Per step faces turn by less than a right angle, but turns add up; only a look at what lies around
/// a face tells that it has come to lie on it. u == v: the faces around v as they are.
[[nodiscard]] bool folds_faces(const LiveMesh& mesh, Index u, Index v);

/// Splits vertices into classes of which no two members are neighbours: those of a class can be worked on at once.
/// Greedy in the order given; classes keep that order.
[[nodiscard]] std::vector<std::vector<Index>> independent_classes(const LiveMesh& mesh, std::span<const Index> vertices,
                                                                  const RunContext& context);

}  // namespace shapelight::simplification
