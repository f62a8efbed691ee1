#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shapelight/core/error.hpp"
#include "shapelight/spatial/triangle_tree.hpp"
#include "support/random_points.hpp"
#include "support/shapes.hpp"
#include "support/triangles.hpp"

// TriangleTree::first_hit().
namespace shapelight {
namespace {

using testing::mesh_of;
using testing::random_triangles;

using Long = Eigen::Matrix<long double, 3, 1>;

// By Cramer's rule in long double (Moeller and Trumbore): distance, or infinity.
long double oracle_distance(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr long double kInfinity = std::numeric_limits<long double>::infinity();
  const Long d = direction.cast<long double>(), e1 = (b.cast<long double>() - a.cast<long double>()),
             e2 = (c.cast<long double>() - a.cast<long double>()),
             s = origin.cast<long double>() - a.cast<long double>();
  const long double det = d.cross(e2).dot(e1);
  if (det == 0.0L) return kInfinity;
  const long double u = s.dot(d.cross(e2)) / det, v = d.dot(s.cross(e1)) / det, t = e2.dot(s.cross(e1)) / det;
  return u >= 0.0L && v >= 0.0L && u + v <= 1.0L && t > 0.0L ? t : kInfinity;
}

double brute_force(const TriangleMesh& mesh, const Vec3& origin, const Vec3& direction) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    best = std::min(
        best, oracle_distance(origin, direction, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  return static_cast<double>(best);
}

// Random rays agree with brute force to the last digits. Returns how many hit.
std::size_t expect_exact(const TriangleMesh& mesh, const std::vector<Vec3>& origins, const std::vector<Vec3>& targets,
                         double tolerance) {
  const TriangleTree tree(mesh);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const Vec3 direction = targets[i] - origins[i];
    const double expected = brute_force(mesh, origins[i], direction);
    const TriangleTree::RayHit hit = tree.first_hit(origins[i], direction);
    EXPECT_EQ(static_cast<bool>(hit), expected < HUGE_VAL) << "ray " << i;
    if (!hit || expected == HUGE_VAL) continue;
    ++hits;
    EXPECT_NEAR(hit.distance, expected, tolerance * expected) << "ray " << i;
    EXPECT_NEAR((origins[i] + hit.distance * direction - hit.point).norm(), 0.0,
                tolerance * direction.norm() * expected);
    const Triangle& t = mesh.triangles[hit.triangle];
    const Vec3 normal =
        (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    EXPECT_NEAR(hit.normal.dot(normal.normalized()), 1.0, 1e-9);
  }
  return hits;
}

TEST(TriangleRay, OneTriangle) {
  const TriangleTree tree(TriangleMesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}});
  const TriangleTree::RayHit hit = tree.first_hit({1, 1, 3}, {0, 0, -2});
  EXPECT_EQ(hit.triangle, 0U);
  EXPECT_EQ(hit.distance, 1.5) << "in lengths of the direction";
  EXPECT_EQ(hit.point, Vec3(1, 1, 0));
  EXPECT_EQ(hit.normal, Vec3(0, 0, 1));
  EXPECT_TRUE(tree.first_hit({1, 1, -3}, {0, 0, 1})) << "from below as well";
  EXPECT_TRUE(tree.first_hit({0, 0, 1}, {0, 0, -1})) << "at a corner";
  EXPECT_TRUE(tree.first_hit({2, 0, 1}, {0, 0, -1})) << "on an edge";
  EXPECT_FALSE(tree.first_hit({3, 3, 3}, {0, 0, -1})) << "beside it";
  EXPECT_FALSE(tree.first_hit({1, 1, 3}, {0, 0, 1})) << "behind the origin";
  EXPECT_FALSE(tree.first_hit({1, 1, 0}, {0, 0, 1})) << "at the origin itself";
  EXPECT_FALSE(tree.first_hit({-1, 1, 0}, {1, 0, 0})) << "along its plane";
}

TEST(TriangleRay, EqualsBruteForce) {
  const std::vector<Vec3> origins = test::random_points(400, 11), targets = test::random_points(400, 12);
  std::vector<Vec3> outside = origins;
  for (Vec3& o : outside) o = 6.0 * (o - Vec3(0.5, 0.5, 0.5));
  for (const double size : {0.02, 0.3, 1.0}) {
    EXPECT_GT(expect_exact(random_triangles(900, size, 2), origins, targets, 1e-10), size < 0.1 ? 3U : 100U);
    EXPECT_GT(expect_exact(random_triangles(900, size, 2), outside, targets, 1e-10), size < 0.1 ? 3U : 100U);
  }
  for (const std::size_t count : {1, 2, 3, 4, 5, 6, 17}) {
    (void)expect_exact(random_triangles(count, 1.0, 3), origins, targets, 1e-10);
  }
}

TEST(TriangleRay, AlongTheAxes) {
  const TriangleMesh mesh = mesh_of(testing::sphere(3, 1.0));
  const std::vector<Vec3> places = test::random_points(100, 4);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      std::vector<Vec3> origins = places, targets;
      for (Vec3& o : origins) {
        o = 1.6 * (o - Vec3(0.5, 0.5, 0.5));
        o[axis] = -3.0 * sign;
        targets.push_back(o + sign * Vec3::Unit(axis));
      }
      EXPECT_GT(expect_exact(mesh, origins, targets, 1e-12), 50U);
    }
  }
}

// Rays from the inside of a closed surface at its vertices and at points of its edges: none gets out.
TEST(TriangleRay, NothingSlipsThroughEdges) {
  for (const double jitter : {0.0, 0.3}) {
    const TriangleMesh mesh = mesh_of(testing::sphere(5, 1.0, jitter));
    const TriangleTree tree(mesh);
    for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.1), Vec3(1.0 / 3, 1.0 / 7, -0.6)}) {
      for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3 &a = mesh.positions[t[k]], &b = mesh.positions[t[(k + 1) % 3]];
          for (const double share : {0.0, 0.5, 0.3}) {
            ASSERT_TRUE(tree.first_hit(origin, (1.0 - share) * a + share * b - origin));
          }
        }
      }
    }
  }
}

TEST(TriangleRay, TiesGoToTheSmallestIndex) {
  TriangleMesh mesh = mesh_of(testing::sphere(3, 1.0));
  const TriangleTree tree(mesh);
  const auto count = static_cast<Index>(mesh.triangles.size());
  const std::vector<Triangle> once = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
  const TriangleTree doubled(mesh);
  std::copy(once.rbegin(), once.rend(), mesh.triangles.begin());
  const TriangleTree mirrored(mesh);
  for (const Vec3& p : test::random_points(300, 6)) {
    const Vec3 direction = p - Vec3(0.5, 0.5, 0.5);
    const Index expected = tree.first_hit(Vec3::Zero(), direction).triangle;
    EXPECT_EQ(doubled.first_hit(Vec3::Zero(), direction).triangle, expected);
    EXPECT_EQ(mirrored.first_hit(Vec3::Zero(), direction).triangle, count - 1 - expected);
  }
  // Four triangles about a corner straight ahead.
  const TriangleTree fan(TriangleMesh{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}},
                                      {{0, 3, 4}, {0, 2, 3}, {0, 1, 2}, {0, 4, 1}}});
  EXPECT_EQ(fan.first_hit(Vec3::Zero(), {0, 0, 1}).triangle, 0U);
}

TEST(TriangleRay, FarOffsetsAndScales) {
  const TriangleMesh base = random_triangles(300, 0.5, 2);
  const TriangleTree plain(base);
  const std::vector<Vec3> origins = test::random_points(60, 1), targets = test::random_points(60, 5);
  for (const double scale : {1e-200, 1e-3, 1e30, 1e140}) {
    TriangleMesh mesh = base;
    for (Vec3& p : mesh.positions) p *= scale;
    const TriangleTree tree(mesh);
    for (std::size_t i = 0; i < origins.size(); ++i) {
      const Vec3 direction = targets[i] - origins[i];
      const TriangleTree::RayHit expected = plain.first_hit(origins[i], direction);
      for (const double length : {1e-150, 1.0, 1e100}) {
        const TriangleTree::RayHit hit = tree.first_hit(scale * origins[i], length * direction);
        ASSERT_EQ(hit.triangle, expected.triangle) << scale;
        if (hit) {
          ASSERT_NEAR((hit.point / scale - expected.point).norm(), 0.0, 1e-12) << scale;
          ASSERT_NEAR(hit.distance / scale * length, expected.distance, 1e-12) << scale;
        }
      }
    }
  }
  const Vec3 utm(448262.0, 5411932.0, 512.0);
  TriangleMesh moved = base;
  for (Vec3& p : moved.positions) p += utm;
  const TriangleTree tree(moved);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const Vec3 direction = targets[i] - origins[i];
    const TriangleTree::RayHit hit = tree.first_hit(origins[i] + utm, direction),
                               expected = plain.first_hit(origins[i], direction);
    ASSERT_EQ(hit.triangle, expected.triangle);
    if (hit) {
      ASSERT_NEAR((hit.point - utm - expected.point).norm(), 0.0, 1e-8);
    }
  }
}

TEST(TriangleRay, DegenerateTrianglesAndRaysMeetNothing) {
  const Vec3 a(0, 0, 0), b(1, 1, 0);
  const TriangleTree flat(TriangleMesh{{a, b, Vec3(0.5 * (a + b))}, {{0, 1, 2}, {0, 0, 1}, {2, 2, 2}}});
  EXPECT_FALSE(flat.first_hit({0.25, 0.25, 1}, {0, 0, -1}));
  const TriangleTree tree(mesh_of(testing::sphere(1, 1.0)));
  const double nan = std::nan("");
  EXPECT_FALSE(tree.first_hit(Vec3::Zero(), Vec3::Zero()));
  EXPECT_FALSE(tree.first_hit({nan, 0, 0}, {1, 0, 0}));
  EXPECT_FALSE(tree.first_hit(Vec3::Zero(), {1, nan, 0}));
  EXPECT_FALSE(tree.first_hit(Vec3::Zero(), {HUGE_VAL, 0, 0}));
  EXPECT_FALSE(tree.first_hit({HUGE_VAL, 0, 0}, {-1, 0, 0}));
  EXPECT_THROW((void)TriangleTree().first_hit(Vec3::Zero(), {1, 0, 0}), InvalidInput);
}

}  // namespace
}  // namespace shapelight
