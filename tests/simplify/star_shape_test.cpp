#include "simplify/star_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.hpp"
#include "simplify/measured_collapse.hpp"
#include "simplify/measured_flips.hpp"
#include "simplify/vertex_fit.hpp"
#include "simplify/vertex_moves.hpp"
#include "support/shapes.hpp"

namespace shapelight::simplification {
namespace {

// A square 0 1 2 3 about vertex 4, and a face beyond edge 1-2.
TriangleMesh square() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}, {2, 0.5, 0}},
          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 5, 2}}};
}

struct Measured {
  ManifoldMesh input;
  MeasuredMesh mesh;
  explicit Measured(const TriangleMesh& whole)
      : input(make_manifold(whole, {}, {}, nullptr)),
        mesh(input, input.mesh.positions, ManifoldMesh(input), {.normal_weight = 0.02}, {}) {}
};

std::size_t folds(const LiveMesh& mesh) {
  std::size_t count = 0;
  for (Index v = 0; v < mesh.num_vertices(); ++v) count += mesh.is_alive(v) && folds_faces(mesh, v, v);
  return count;
}

TEST(FoldsFaces, SeesAFaceThatLiesOnAllItsNeighbours) {
  LiveMesh mesh(make_manifold(square(), {}, {}, nullptr));
  EXPECT_EQ(folds(mesh), 0U);
  mesh.position[4] = {1.2, 0.5, 0.0};  // face (1, 2, 4) turns over
  EXPECT_TRUE(folds_faces(mesh, 4, 4));
  EXPECT_TRUE(folds_faces(mesh, 5, 5));  // the one beside it
  mesh.position[4] = {1.2, 0.5, 5.0};    // upright
  EXPECT_EQ(folds(mesh), 0U);
}

TEST(FoldsFaces, LooksAheadOfARemoval) {
  // Vertex 4 in a ring 0 1 2 3 that is not convex at 2; faces beyond its edges 1-2 and 2-3.
  const TriangleMesh flat{{{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}, {0.3, 0.3, 0}, {2, 2, 0}},
                          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {2, 1, 5}, {3, 2, 5}}};
  const LiveMesh mesh(make_manifold(flat, {}, {}, nullptr));
  EXPECT_FALSE(folds_faces(mesh, 4, 0));
  EXPECT_FALSE(folds_faces(mesh, 4, 2));
  EXPECT_TRUE(folds_faces(mesh, 4, 1));  // leaves (1, 2, 3)
  EXPECT_TRUE(folds_faces(mesh, 4, 3));
}

TEST(FoldsFaces, TwoFacesBackToBackHoldEachOtherNot) {
  const LiveMesh pillow(
      make_manifold({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-6}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}},
                    {}, {}, nullptr));
  EXPECT_TRUE(folds_faces(pillow, 0, 0));
  const LiveMesh alone(make_manifold({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, {}, {}, nullptr));
  EXPECT_FALSE(folds_faces(alone, 0, 0));  // no neighbour to lie on
}

TEST(PutFoldedBack, OnlyThoseThatFold) {
  Measured m(square());
  const std::vector<Vec3> before = {m.mesh.mesh.position[4]};
  const Index moved[1] = {4};
  m.mesh.mesh.position[4] = {0.6, 0.5, 0.0};
  EXPECT_TRUE(put_folded_back(m.mesh, moved, before, {}).empty());
  m.mesh.mesh.position[4] = {1.2, 0.5, 0.0};
  EXPECT_EQ(put_folded_back(m.mesh, moved, before, {}), std::vector<std::size_t>{0});
  EXPECT_EQ(m.mesh.mesh.position[4], before[0]);
}

// Rough shapes, on which turns add up.
class RoughShape : public ::testing::TestWithParam<int> {};

TriangleMesh rough(int seed) {
  auto shape = shapelight::testing::plane(40, 1.0, 0.2);
  for (Index v = 0; v < shape.positions.size(); ++v) shape.positions[v][2] = 4.0 * random01(seed, 0, v);
  return {shape.positions, shape.triangles};
}

std::vector<Index> alive(const LiveMesh& mesh) {
  std::vector<Index> out;
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    if (mesh.is_alive(v)) out.push_back(v);
  }
  return out;
}

TEST_P(RoughShape, CollapsesFlipsAndFitsFoldNothing) {
  Measured m(rough(GetParam()));
  const LiveMesh& mesh = m.mesh.mesh;
  ASSERT_EQ(folds(mesh), 0U);
  const TriangleMesh surface{m.input.mesh.positions, m.input.mesh.triangles};
  InputSurface input(surface, mesh.num_vertices(), {});
  ASSERT_TRUE(collapse_measured(m.mesh, mesh.num_vertices() / 2, {}, {}));
  EXPECT_EQ(folds(mesh), 0U) << "collapses";
  for (int pass = 0; pass < 4; ++pass) {
    (void)flip_edges(m.mesh, {});
    EXPECT_EQ(folds(mesh), 0U) << "flips";
    fit_vertices(m.mesh, alive(mesh), 0.02, input, {});
    EXPECT_EQ(folds(mesh), 0U) << "fit";
  }
}

TEST_P(RoughShape, MovesFoldNothingAndStayOnTheirSources) {
  Measured m(rough(GetParam()));
  const LiveMesh& mesh = m.mesh.mesh;
  ASSERT_TRUE(collapse_measured(m.mesh, 3 * mesh.num_vertices() / 4, {}, {}));
  const std::vector<Index> left = alive(mesh);
  std::vector<std::uint8_t> taken(mesh.num_vertices(), 0);
  for (const Index v : left) taken[mesh.source[v]] = 1;
  InputPlaces places{m.input.mesh.positions, m.input.line, m.input.locked, taken};
  for (int pass = 0; pass < 4; ++pass) {
    (void)move_vertices(m.mesh, places, 0.02, {});
    EXPECT_EQ(folds(mesh), 0U);
    std::fill(taken.begin(), taken.end(), 0);
    for (const Index v : left) {
      EXPECT_EQ(mesh.position[v], m.input.mesh.positions[mesh.source[v]]);
      EXPECT_EQ(taken[mesh.source[v]]++, 0);
    }
    EXPECT_EQ(places.taken, taken);
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, RoughShape, ::testing::Range(0, 6));

}  // namespace
}  // namespace shapelight::simplification
