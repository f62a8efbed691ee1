#include "simplify/measured_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shapelight/spatial/triangle_tree.hpp"
#include "simplify/measured_collapse.hpp"
#include "simplify/measured_flips.hpp"
#include "simplify/star_shape.hpp"
#include "simplify/vertex_fit.hpp"
#include "simplify/vertex_moves.hpp"
#include "support/shapes.hpp"

namespace shapelight::simplification {
namespace {

using shapelight::testing::Shape;

struct Measured {
  ManifoldMesh input;
  MeasuredMesh mesh;

  explicit Measured(const Shape& shape, const SampleScheme& scheme = {})
      : input(prepare(shape)), mesh(input, input.mesh.positions, ManifoldMesh(input), scheme, {}) {}

  static ManifoldMesh prepare(const Shape& shape) {
    return make_manifold({shape.positions, shape.triangles}, {}, {}, nullptr);
  }
};

double energy(const MeasuredMesh& measured) {
  double sum = 0.0;
  for (Index f = 0; f < measured.mesh.num_faces(); ++f) {
    if (!measured.mesh.is_face_alive(f)) continue;
    measured.for_samples(f, [&](const SurfaceSample& s) { sum += s.error; });
  }
  for (Index e = 0; e < measured.mesh.num_line_edges(); ++e) sum += measured.line_energy(e);
  return sum;
}

// Every sample's error is that of the face that it is attached to, and no sample is lost.
void expect_true_errors(const MeasuredMesh& measured, std::size_t num_samples) {
  const LiveMesh& mesh = measured.mesh;
  std::size_t seen = 0;
  for (Index f = 0; f < mesh.num_faces(); ++f) {
    if (!mesh.is_face_alive(f)) continue;
    measured.for_samples(f, [&](const SurfaceSample& s) {
      ++seen;
      const Triangle& t = mesh.face(f);
      const Vec3 &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
      const Vec3 n = (b - a).cross(c - a).normalized();
      const double distance_sq = (closest_point_on_triangle(s.position, a, b, c) - s.position).squaredNorm();
      const double expected =
          s.weight * distance_sq + s.turn * (1.0 - n.dot(Vec3(s.normal[0], s.normal[1], s.normal[2])));
      EXPECT_NEAR(s.error, expected, 1e-6 * (s.weight + s.turn));
    });
  }
  EXPECT_EQ(seen, num_samples);
}

std::size_t num_samples(const Shape& shape) { return shape.positions.size() + shape.triangles.size(); }

TEST(MeasuredMesh, UntouchedMeshHasNoError) {
  const Measured m(shapelight::testing::saddle(12, 0.1));
  EXPECT_NEAR(energy(m.mesh), 0.0, 1e-9);
  expect_true_errors(m.mesh, num_samples(shapelight::testing::saddle(12, 0.1)));
}

TEST(MeasuredMesh, WeightsOfTheSamplesAreTheArea) {
  const Measured m(shapelight::testing::sphere(4, 1.0));
  double weight = 0.0;
  for (Index f = 0; f < m.mesh.mesh.num_faces(); ++f) {
    m.mesh.for_samples(f, [&](const SurfaceSample& s) { weight += s.weight; });
  }
  EXPECT_NEAR(weight, 4.0 * std::numbers::pi, 0.03);
}

TEST(MeasuredCollapse, RemovesExactlyAsManyAndKeepsErrorsTrue) {
  const Shape shape = shapelight::testing::sphere(3, 1.0, 0.2);
  Measured m(shape);
  ASSERT_TRUE(collapse_measured(m.mesh, 500, {}, {}));
  EXPECT_EQ(m.mesh.mesh.num_live_vertices(), shape.positions.size() - 500);
  expect_true_errors(m.mesh, num_samples(shape));
  EXPECT_GT(energy(m.mesh), 0.0);
}

TEST(MeasuredCollapse, PlaneLosesItsInsideForNothing) {
  const Shape shape = shapelight::testing::plane(12, 1.0);
  Measured m(shape);
  const std::size_t inside = 10 * 10;
  ASSERT_TRUE(collapse_measured(m.mesh, inside, {}, {}));
  EXPECT_NEAR(energy(m.mesh), 0.0, 1e-9);
}

TEST(MeasuredCollapse, SaysWhenTopologyAllowsNoMore) {
  Measured m(shapelight::testing::sphere(1, 1.0));
  EXPECT_FALSE(collapse_measured(m.mesh, 39, {}, {}));  // 42 vertices: 38 can go
  EXPECT_EQ(m.mesh.mesh.num_live_vertices(), 4U);
}

TEST(MeasuredCollapse, HeavierVerticesStayLonger) {
  const Shape shape = shapelight::testing::sphere(3, 1.0, 0.2);
  std::vector<float> weight(shape.positions.size(), 1.0F);
  for (std::size_t v = 0; v < weight.size(); v += 3) weight[v] = 10.0F;
  const auto kept_heavy = [&](std::span<const float> w) {
    Measured m(shape);
    EXPECT_TRUE(collapse_measured(m.mesh, 430, {.removal_weight = w}, {}));
    std::size_t kept = 0;
    for (Index v = 0; v < shape.positions.size(); v += 3) kept += m.mesh.mesh.is_alive(v);
    return kept;
  };
  EXPECT_GT(kept_heavy(weight), kept_heavy({}) + 30);
}

TEST(MeasuredFlips, TurnADiagonalIntoTheCrease) {
  // A roof whose ridge joins vertices 1 and 3; the diagonal between 0 and 2 would cut it off.
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, -2, 0.4}, {2, 0, 0}, {1, 2, 0.4}};
  const ManifoldMesh roof = make_manifold({corners, {{0, 1, 3}, {1, 2, 3}}}, {}, {}, nullptr);
  MeasuredMesh measured(roof, roof.mesh.positions, make_manifold({corners, {{0, 1, 2}, {0, 2, 3}}}, {}, {}, nullptr),
                        {}, {});
  ASSERT_GT(energy(measured), 0.01);
  EXPECT_EQ(flip_edges(measured, {}), 1U);
  EXPECT_NEAR(energy(measured), 0.0, 1e-9);
}

TEST(MeasuredFlips, NeverRaiseTheEnergy) {
  const Shape shape = shapelight::testing::saddle(16, 0.2, 0.2);
  Measured m(shape);
  ASSERT_TRUE(collapse_measured(m.mesh, 180, {}, {}));
  double before = energy(m.mesh);
  while (flip_edges(m.mesh, {}) > 0) {
    const double after = energy(m.mesh);
    EXPECT_LT(after, before);
    before = after;
  }
  expect_true_errors(m.mesh, num_samples(shape));
}

TEST(VertexFit, BringsACoarseSphereOffTheInscribedOne) {
  const Shape shape = shapelight::testing::sphere(4, 1.0);
  Measured m(shape);
  ASSERT_TRUE(collapse_measured(m.mesh, shape.positions.size() - 100, {}, {}));
  const double inscribed = energy(m.mesh);
  const TriangleMesh surface{m.input.mesh.positions, m.input.mesh.triangles};
  InputSurface input(surface, m.mesh.mesh.num_vertices(), {});
  std::vector<Index> alive;
  for (Index v = 0; v < m.mesh.mesh.num_vertices(); ++v) {
    if (m.mesh.mesh.is_alive(v)) alive.push_back(v);
  }
  for (int sweep = 0; sweep < 4; ++sweep) fit_vertices(m.mesh, alive, 0.1, input, {});
  EXPECT_LT(energy(m.mesh), 0.5 * inscribed);
  double radius = 0.0;
  for (const Index v : alive) radius += m.mesh.mesh.position[v].norm();
  EXPECT_GT(radius / static_cast<double>(alive.size()), 1.005);  // vertices stand outside, faces straddle the sphere
  expect_true_errors(m.mesh, num_samples(shape));
}

TEST(VertexMoves, LowerTheEnergyAndStayOnFreeInputVertices) {
  const Shape shape = shapelight::testing::saddle(24, 0.1, 0.2);
  Measured m(shape);
  ASSERT_TRUE(collapse_measured(m.mesh, 480, {}, {}));
  const double before = energy(m.mesh);
  InputPlaces places{m.input.mesh.positions, m.input.line, m.input.locked,
                     std::vector<std::uint8_t>(shape.positions.size(), 0)};
  for (Index v = 0; v < m.mesh.mesh.num_vertices(); ++v) {
    if (m.mesh.mesh.is_alive(v)) places.taken[m.mesh.mesh.source[v]] = 1;
  }
  EXPECT_GT(move_vertices(m.mesh, places, 0.1, {}), 0U);
  EXPECT_LT(energy(m.mesh), before);
  std::vector<std::uint8_t> used(shape.positions.size(), 0);
  for (Index v = 0; v < m.mesh.mesh.num_vertices(); ++v) {
    if (!m.mesh.mesh.is_alive(v)) continue;
    EXPECT_EQ(m.mesh.mesh.position[v], m.input.mesh.positions[m.mesh.mesh.source[v]]);
    EXPECT_EQ(used[m.mesh.mesh.source[v]]++, 0) << "two vertices on one place";
  }
  EXPECT_EQ(used, places.taken);
  expect_true_errors(m.mesh, num_samples(shape));
}

TEST(IndependentClasses, NoTwoNeighboursShareOneAndNobodyIsLeftOut) {
  const Measured m(shapelight::testing::sphere(3, 1.0));
  std::vector<Index> all(m.mesh.mesh.num_vertices());
  for (Index v = 0; v < all.size(); ++v) all[v] = v;
  std::size_t count = 0;
  for (const std::vector<Index>& members : independent_classes(m.mesh.mesh, all, {})) {
    count += members.size();
    for (const Index v : members) {
      std::vector<Index> ring;
      m.mesh.mesh.neighbors(v, ring);
      for (const Index w : ring) EXPECT_EQ(std::count(members.begin(), members.end(), w), 0);
    }
  }
  EXPECT_EQ(count, all.size());
}

}  // namespace
}  // namespace shapelight::simplification
