#include "simplify/live_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/mesh_topology.hpp"
#include "support/shapes.hpp"

namespace shapelight::simplification {
namespace {

using shapelight::testing::Shape;
using shapelight::testing::topology;

LiveMesh live(const TriangleMesh& mesh, const FeatureEdges& features = {}) {
  return LiveMesh(make_manifold(mesh, features, {}, nullptr));
}
LiveMesh live(const Shape& shape) { return live(TriangleMesh{shape.positions, shape.triangles}); }

// Stars hold exactly the live faces of each vertex.
void expect_consistent(const LiveMesh& mesh) {
  std::vector<std::size_t> faces(mesh.num_vertices(), 0);
  std::size_t live_faces = 0;
  for (Index f = 0; f < mesh.num_faces(); ++f) {
    if (!mesh.is_face_alive(f)) continue;
    ++live_faces;
    for (const Index v : mesh.face(f)) {
      ++faces[v];
      EXPECT_EQ(std::count(mesh.star(v).begin(), mesh.star(v).end(), f), 1);
    }
  }
  EXPECT_EQ(live_faces, mesh.num_live_faces());
  std::size_t live_vertices = 0;
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    EXPECT_EQ(mesh.star(v).size(), faces[v]);
    live_vertices += mesh.is_alive(v);
  }
  EXPECT_EQ(live_vertices, mesh.num_live_vertices());
}

// Collapses any edge that may be, until none is left.
void collapse_all(LiveMesh& mesh) {
  std::vector<Index> ring;
  for (bool again = true; again;) {
    again = false;
    for (Index u = 0; u < mesh.num_vertices(); ++u) {
      mesh.neighbors(u, ring);
      for (const Index v : ring) {
        if (!mesh.may_collapse(u, v)) continue;
        mesh.collapse(u, v);
        again = true;
        break;
      }
    }
  }
}

TEST(LiveMesh, ClosedSurfaceCollapsesToATetrahedronAndNoFurther) {
  LiveMesh mesh = live(shapelight::testing::sphere(2, 1.0));
  collapse_all(mesh);
  expect_consistent(mesh);
  EXPECT_EQ(mesh.num_live_vertices(), 4U);
  EXPECT_EQ(mesh.num_live_faces(), 4U);
}

TEST(LiveMesh, OpenSurfaceCollapsesToATriangleAlongItsBorder) {
  LiveMesh mesh = live(shapelight::testing::plane(7, 1.0));
  collapse_all(mesh);
  expect_consistent(mesh);
  EXPECT_EQ(mesh.num_live_vertices(), 3U);
  EXPECT_EQ(mesh.num_live_faces(), 1U);
}

TEST(LiveMesh, TorusKeepsItsHandle) {
  const Shape torus = shapelight::testing::torus(12, 8, 2.0, 0.7);
  LiveMesh mesh = live(torus);
  collapse_all(mesh);
  expect_consistent(mesh);
  const ManifoldMesh out = std::move(mesh).compact();
  EXPECT_EQ(topology(out.mesh.triangles).euler(), 0);
  EXPECT_GE(out.mesh.positions.size(), 7U);  // no torus has fewer vertices
}

TEST(LiveMesh, BorderVertexStaysOnItsLine) {
  // A fan of three faces about vertex 0, which lies on the border itself: 1 - 2 - 3 - 4 - 0.
  const TriangleMesh fan{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}};
  const LiveMesh mesh = live(fan);
  EXPECT_FALSE(mesh.may_collapse(2, 0));  // an inner edge between border vertices
  EXPECT_TRUE(mesh.may_collapse(2, 3));
  EXPECT_FALSE(mesh.may_collapse(2, 4));  // no edge at all
}

TEST(LiveMesh, LineEdgeTakesOverWhatTheRemovedVertexJoined) {
  LiveMesh mesh = live(shapelight::testing::plane(5, 1.0));
  const Index u = 2;  // on the lower border, between 1 and 3
  ASSERT_TRUE(mesh.is_line_edge(1, u) && mesh.is_line_edge(u, 3));
  ASSERT_TRUE(mesh.may_collapse(u, 3));
  mesh.collapse(u, 3);
  EXPECT_TRUE(mesh.is_line_edge(1, 3));
  EXPECT_FALSE(mesh.is_on_line(u));
  expect_consistent(mesh);
}

TEST(LiveMesh, FeatureLineThatClosesOnItselfKeepsThreeVertices) {
  const Shape shape = shapelight::testing::sphere(3, 1.0);
  FeatureEdges ring;  // about vertex 0
  for (const Triangle& t : shape.triangles) {
    for (int k = 0; k < 3; ++k) {
      if (t[k] == 0) ring.push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
    }
  }
  LiveMesh mesh = live(TriangleMesh{shape.positions, shape.triangles}, ring);
  collapse_all(mesh);
  std::size_t on_line = 0;
  for (Index v = 0; v < mesh.num_vertices(); ++v) on_line += mesh.is_alive(v) && mesh.is_on_line(v);
  EXPECT_EQ(on_line, 3U);
}

TEST(LiveMesh, FlipAndItsReverse) {
  LiveMesh mesh = live(shapelight::testing::sphere(1, 1.0));
  const auto [f, g] = mesh.faces_at_edge(mesh.face(0)[0], mesh.face(0)[1]);
  std::array<Index, 4> quad{};
  ASSERT_TRUE(mesh.may_flip(f, g, quad));
  const Triangle before = mesh.face(f);
  mesh.flip(f, g, quad);
  expect_consistent(mesh);
  std::array<Index, 4> back{};
  ASSERT_TRUE(mesh.may_flip(f, g, back));
  mesh.flip(f, g, back);
  expect_consistent(mesh);
  EXPECT_TRUE(std::is_permutation(before.begin(), before.end(), mesh.face(f).begin()) ||
              std::is_permutation(before.begin(), before.end(), mesh.face(g).begin()));
}

TEST(LiveMesh, FlipNeverDoublesAnEdgeNorCrossesALine) {
  const TriangleMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                 {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  std::array<Index, 4> quad{};
  EXPECT_FALSE(live(tetrahedron).may_flip(0, 1, quad));
  const Shape sphere = shapelight::testing::sphere(1, 1.0);
  const Triangle& t = sphere.triangles[0];
  const LiveMesh marked = live(TriangleMesh{sphere.positions, sphere.triangles}, {{t[0], t[1]}});
  const auto [f, g] = marked.faces_at_edge(t[0], t[1]);
  EXPECT_FALSE(marked.may_flip(f, g, quad));
}

}  // namespace
}  // namespace shapelight::simplification
