#include "simplify/check_result.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>

#include "shapelight/core/error.hpp"
#include "simplify/turned_faces.hpp"
#include "support/shapes.hpp"

// Every promise about a simplified mesh, each broken by hand once.
namespace shapelight {
namespace {

using namespace shapelight::testing;

SimplifiedMesh identity(const TriangleMesh& mesh) {
  MeshOddities oddities;
  return without_oddities(mesh, oddities);
}

TriangleMesh mesh_of(const Shape& shape) { return {shape.positions, shape.triangles}; }

// The message of the promise that `result` breaks; empty when it keeps them all.
std::string broken(const SimplifiedMesh& reference, const SimplifiedMesh& result, SimplifyTarget target = {},
                   Placement placement = Placement::Input) {
  if (target.vertices == 0 && target.faces == 0) target.vertices = result.mesh.positions.size();
  try {
    check_result(reference, result, target, placement);
  } catch (const PostconditionFailed& failed) {
    EXPECT_EQ(failed.exit_code(), 6);
    return failed.what();
  }
  return "";
}

void expect_broken(const std::string& said, const std::string& expected) {
  EXPECT_NE(said.find(expected), std::string::npos) << "said '" << said << "', expected '" << expected << "'";
}

// Takes out the faces for which `leaves` says so, and the vertices that no face uses then.
SimplifiedMesh without(const SimplifiedMesh& whole, const std::function<bool(const Triangle&)>& leaves) {
  TriangleMesh mesh = whole.mesh;
  std::erase_if(mesh.triangles, leaves);
  return identity(mesh);
}

TEST(CheckResult, TheInputItselfIsFine) {
  for (const Shape& shape : {sphere(2, 1.0), plane(8, 1.0), torus(12, 8, 3.0, 1.0), cylinder(8, 5, 1.0)}) {
    const SimplifiedMesh whole = identity(mesh_of(shape));
    EXPECT_EQ(broken(whole, whole), "") << shape.name;
    EXPECT_EQ(broken(whole, whole, {.vertices = 0, .faces = whole.mesh.triangles.size() + 1}), "") << shape.name;
  }
}

TEST(CheckResult, CountsAreExact) {
  const SimplifiedMesh whole = identity(mesh_of(sphere(1, 1.0)));  // 42 vertices, 80 faces
  expect_broken(broken(whole, whole, {.vertices = 41, .faces = 0}), "42 vertices, expected 41");
  expect_broken(broken(whole, whole, {.vertices = 0, .faces = 78}), "80 faces, expected 78");
  expect_broken(broken(whole, whole, {.vertices = 0, .faces = 82}), "80 faces, expected 82");
}

TEST(CheckResult, VerticesAreThoseOfTheInput) {
  const SimplifiedMesh whole = identity(mesh_of(sphere(1, 1.0)));
  SimplifiedMesh moved = whole;
  moved.mesh.positions[7].x() += 1e-15;
  expect_broken(broken(whole, moved), "vertex 7 is not where its source 7 is");
  EXPECT_EQ(broken(whole, moved, {}, Placement::Optimal), "");
  SimplifiedMesh lost = whole;
  lost.source_vertex[3] = 1000;
  expect_broken(broken(whole, lost), "vertex 3: source 1000");
  SimplifiedMesh infinite = whole;
  infinite.mesh.positions[5].y() = std::numeric_limits<double>::infinity();
  expect_broken(broken(whole, infinite, {}, Placement::Optimal), "vertex 5 is not finite");
  SimplifiedMesh unused = whole;
  unused.mesh.positions.emplace_back(0, 0, 0);
  unused.source_vertex.push_back(0);
  expect_broken(broken(whole, unused, {}, Placement::Optimal), "vertex 42 is in no face");
  SimplifiedMesh sourceless = whole;
  sourceless.source_vertex.pop_back();
  expect_broken(broken(whole, sourceless), "41 sources for 42 vertices");
}

TEST(CheckResult, FacesHaveThreeVerticesOfTheirOwn) {
  const SimplifiedMesh whole = identity(mesh_of(plane(4, 1.0)));
  SimplifiedMesh repeated = whole;
  repeated.mesh.triangles.push_back({2, 5, 2});
  expect_broken(broken(whole, repeated), "vertices 2 5 2");
  SimplifiedMesh outside = whole;
  outside.mesh.triangles.push_back({2, 5, 16});
  expect_broken(broken(whole, outside), "vertex >= 16");
  SimplifiedMesh twice = whole;
  const Triangle t = twice.mesh.triangles[4];
  twice.mesh.triangles.push_back({t[1], t[0], t[2]});
  expect_broken(broken(whole, twice), "two faces over vertices");
}

TEST(CheckResult, NoHoleNoHandleNoLostPart) {
  const SimplifiedMesh ball = identity(mesh_of(sphere(2, 1.0)));
  const auto at = [](Index v) { return [v](const Triangle& t) { return t[0] == v || t[1] == v || t[2] == v; }; };
  expect_broken(broken(ball, without(ball, at(50))), "Euler characteristic 1, expected the input's 2");
  SimplifiedMesh one_face_less = ball;
  one_face_less.mesh.triangles.pop_back();
  expect_broken(broken(ball, one_face_less), "Euler characteristic");
  const SimplifiedMesh tube = identity(mesh_of(cylinder(8, 5, 1.0)));
  expect_broken(broken(tube, without(tube, at(18))), "Euler characteristic -1, expected the input's 0");
  // Two spheres of which one is lost.
  TriangleMesh two = mesh_of(sphere(1, 1.0));
  const std::size_t n = two.positions.size(), faces = two.triangles.size();
  for (std::size_t v = 0; v < n; ++v) two.positions.push_back(two.positions[v] + Vec3(5, 0, 0));
  for (std::size_t f = 0; f < faces; ++f) {
    Triangle t = two.triangles[f];
    for (Index& v : t) v += static_cast<Index>(n);
    two.triangles.push_back(t);
  }
  expect_broken(broken(identity(two), identity(mesh_of(sphere(1, 1.0)))),
                "Euler characteristic 2, expected the input's 4");
}

TEST(CheckResult, MoreBordersAreMoreHoles) {
  // A torus (Euler characteristic 0, no border) against a tube (0, two borders).
  TriangleMesh both = mesh_of(torus(12, 8, 3.0, 1.0));
  const SimplifiedMesh reference = identity(both);
  SimplifiedMesh tube = identity(mesh_of(cylinder(12, 4, 1.0)));
  expect_broken(broken(reference, tube, {}, Placement::Optimal), "2 borders, expected at most the input's 0");
}

TEST(CheckResult, NoEdgeWithMoreThanTwoFacesThatTheInputLacks) {
  const SimplifiedMesh flat = identity(mesh_of(plane(5, 1.0)));
  SimplifiedMesh fin = flat;
  fin.mesh.triangles.push_back({6, 7, 24});  // 6-7 has two faces already
  expect_broken(broken(flat, fin),
                "1 edges with more than two faces, expected at most the input's 0; one is from input vertex 6 to 7");
  // The same fin in the input is its own affair.
  MeshOddities oddities;
  const SimplifiedMesh odd = without_oddities(fin.mesh, oddities);
  EXPECT_EQ(broken(odd, odd), "");
  EXPECT_GT(oddities.locked_vertices, 0u);
}

TEST(CheckResult, NoFaceIsTurnedOver) {
  const SimplifiedMesh flat = identity(mesh_of(plane(5, 1.0)));
  SimplifiedMesh turned = flat;
  std::swap(turned.mesh.triangles[9][1], turned.mesh.triangles[9][2]);
  expect_broken(broken(flat, turned), "face 9 is turned over");
  // Input that is folded like this itself may stay so.
  EXPECT_EQ(broken(turned, turned), "");
}

TEST(TurnedFaces, SharpTipsAndThinSheetsAreNot) {
  // A needle: every face of its tip looks away from its neighbours, but not from the input.
  TriangleMesh needle{{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0.003, 0.003, 5.0}},
                      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  EXPECT_EQ(broken(identity(needle), identity(needle)), "");
  TriangleMesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-6}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  EXPECT_EQ(broken(identity(flat), identity(flat)), "");
}

TEST(TurnedFaces, OneFlipUnfoldsThem) {
  // Vertex 4 of the quad 0 1 2 3 lies outside of it, beyond edge 1-2: face (1, 2, 4) is turned over.
  const TriangleMesh input{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}, {2, 0.5, 0}},
                           {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 5, 2}}};
  const SimplifiedMesh reference = identity(input);
  SimplifiedMesh result = reference;
  result.mesh.positions[4] = Vec3(1.2, 0.5, 0.0);
  expect_broken(broken(reference, result, {}, Placement::Optimal), "is turned over");
  EXPECT_EQ(unfold_faces(reference.mesh, result, Placement::Input, {}, {}), 0u);
  EXPECT_EQ(broken(reference, result, {}, Placement::Optimal), "");
  // A feature along that edge forbids the flip.
  SimplifiedMesh held = reference;
  held.mesh.positions[4] = Vec3(1.2, 0.5, 0.0);
  EXPECT_EQ(unfold_faces(reference.mesh, held, Placement::Input, {{0, 1}, {1, 2}, {1, 4}, {2, 4}}, {}), 1u);
  EXPECT_EQ(held.mesh.triangles, reference.mesh.triangles);
}

TEST(TurnedFaces, AVertexOfThreeFacesMovesInPlaceOfAFlip) {
  // Vertex 3 of three faces lies outside of its ring 0 1 2, far beyond edge 1-2 and the face there.
  const TriangleMesh input{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0}, {0.6, 0.6, 0}},
                           {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 4, 2}}};
  const SimplifiedMesh reference = identity(input);
  SimplifiedMesh result = reference;
  result.mesh.positions[3] = Vec3(1.5, 1.5, 0.0);
  expect_broken(broken(reference, result, {}, Placement::Optimal), "is turned over");
  EXPECT_EQ(unfold_faces(reference.mesh, result, Placement::Optimal, {}, {}), 0u);
  EXPECT_EQ(result.mesh.triangles, reference.mesh.triangles);
  EXPECT_EQ(result.mesh.positions[3], Vec3(1.0 / 3.0, 1.0 / 3.0, 0.0));
}

TEST(TurnedFaces, AnEarFoldedInwardsGoesBackOverItsEdge) {
  // Vertex 4 of face (1, 4, 2), which has no other neighbour than (0, 1, 2), should be on the other side of edge 1-2.
  const TriangleMesh input{{{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {1.3, 0.2, 0}, {1.5, 0, 0}},
                           {{0, 1, 2}, {1, 3, 2}, {1, 4, 3}, {3, 4, 2}}};
  const SimplifiedMesh reference = identity(input);
  SimplifiedMesh ear = identity({{{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {}, {0.6, 0, 0}}, {{0, 1, 2}, {1, 4, 2}}});
  ASSERT_EQ(ear.source_vertex.back(), 4u);
  const FeatureEdges around = {{0, 1}, {1, 2}, {2, 0}};  // no flip
  SimplifiedMesh free = ear;
  EXPECT_EQ(unfold_faces(reference.mesh, free, Placement::Optimal, around, {}), 0u);
  EXPECT_LT((free.mesh.positions[3] - Vec3(1.1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(unfold_faces(reference.mesh, ear, Placement::Input, around, {}), 0u);
  EXPECT_EQ(ear.source_vertex[3], 3u);  // the nearest input vertex there that is not taken
  EXPECT_EQ(ear.mesh.positions[3], input.positions[3]);
}

TEST(TurnedFaces, NothingChangesWhereNothingIsTurned) {
  const SimplifiedMesh whole = identity(mesh_of(sphere(3, 1.0, 0.2)));
  SimplifiedMesh same = whole;
  EXPECT_EQ(unfold_faces(whole.mesh, same, Placement::Input, {}, {}), 0u);
  EXPECT_EQ(same.mesh.triangles, whole.mesh.triangles);
}

}  // namespace
}  // namespace shapelight
