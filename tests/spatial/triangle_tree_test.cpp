#include "shapelight/spatial/triangle_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/random_points.hpp"
#include "support/shapes.hpp"
#include "support/triangles.hpp"

namespace shapelight {
namespace {

using testing::mesh_of;
using testing::random_triangles;

// Distance to a triangle by another road: the plane where the foot is inside, the edges elsewhere.
long double oracle_distance(const Vec3& query, const Vec3& a, const Vec3& b, const Vec3& c) {
  using Long = Eigen::Matrix<long double, 3, 1>;
  const Long q = Long::Zero(), origin = query.cast<long double>();  // nothing is lost at a far offset
  const std::array<Long, 3> p = {a.cast<long double>() - origin, b.cast<long double>() - origin,
                                 c.cast<long double>() - origin};
  long double best = std::numeric_limits<long double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Long edge = p[(k + 1) % 3] - p[k];
    const long double length_sq = edge.squaredNorm();
    const long double t = length_sq > 0.0L ? std::clamp((q - p[k]).dot(edge) / length_sq, 0.0L, 1.0L) : 0.0L;
    best = std::min(best, (p[k] + t * edge - q).norm());
  }
  const Long normal = (p[1] - p[0]).cross(p[2] - p[0]);
  bool inside = normal.squaredNorm() > 0.0L;
  for (std::size_t k = 0; k < 3; ++k) inside = inside && (p[(k + 1) % 3] - p[k]).cross(q - p[k]).dot(normal) >= 0.0L;
  if (inside) best = std::min(best, std::abs((q - p[0]).dot(normal)) / normal.norm());
  return best;
}

double brute_force_distance(const TriangleMesh& mesh, const Vec3& query) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    best = std::min(best, oracle_distance(query, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  return static_cast<double>(best);
}

// Every query: the right distance, to a point that lies there, on the triangle named; the hint changes nothing.
void expect_exact(const TriangleMesh& mesh, const std::vector<Vec3>& queries, double tolerance) {
  const TriangleTree tree(mesh);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const TriangleTree::Hit hit = tree.closest(queries[i]);
    ASSERT_LT(hit.triangle, mesh.triangles.size());
    ASSERT_NEAR(std::sqrt(hit.distance_sq), brute_force_distance(mesh, queries[i]), tolerance) << "query " << i;
    ASSERT_NEAR((hit.point - queries[i]).norm(), std::sqrt(hit.distance_sq), tolerance);
    const Triangle& t = mesh.triangles[hit.triangle];
    const auto off = oracle_distance(hit.point, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
    ASSERT_LE(static_cast<double>(off), tolerance);
    const TriangleTree::Hit hinted = tree.closest(queries[i], static_cast<Index>(i * 7919 % mesh.triangles.size()));
    ASSERT_EQ(hinted.distance_sq, hit.distance_sq);
    ASSERT_EQ(hinted.triangle, hit.triangle);
  }
}

TEST(ClosestPointOnTriangle, EveryRegion) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  const auto closest = [&](double x, double y, double z) { return closest_point_on_triangle({x, y, z}, a, b, c); };
  EXPECT_EQ(closest(-1, -2, 3), a);
  EXPECT_EQ(closest(6, -1, 3), b);
  EXPECT_EQ(closest(-1, 6, 3), c);
  EXPECT_EQ(closest(1, -2, 3), Vec3(1, 0, 0));
  EXPECT_EQ(closest(-2, 1, 3), Vec3(0, 1, 0));
  EXPECT_EQ(closest(3, 3, 3), Vec3(2, 2, 0));
  EXPECT_EQ(closest(1, 1, 3), Vec3(1, 1, 0));
  EXPECT_EQ(closest(1, 1, 0), Vec3(1, 1, 0));
}

TEST(ClosestPointOnTriangle, DegenerateTrianglesAreTheirEdges) {
  const std::vector<Vec3> queries = test::random_points(300, 3);
  const std::vector<Vec3> ends = test::random_points(8, 4);
  for (const Vec3& query : queries) {
    const Vec3 q = 3.0 * (query - Vec3(0.5, 0.5, 0.5));
    for (const Vec3& a : ends) {
      const Vec3 b = ends[0];
      for (const Vec3& c : {a, b, Vec3(0.25 * a + 0.75 * b), Vec3(3.0 * a - 2.0 * b)}) {
        for (const auto& [x, y, z] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}) {
          const Vec3 found = closest_point_on_triangle(q, x, y, z);
          ASSERT_NEAR((found - q).norm(), static_cast<double>(oracle_distance(q, x, y, z)), 1e-12);
        }
      }
    }
  }
}

TEST(ClosestPointOnTriangle, SliversKeepTheirDigits) {
  for (const double height : {1e-3, 1e-5, 1e-7, 1e-9}) {
    const Vec3 a(0.1, 0.2, 0.3), b = a + Vec3(1.0, 0.7, -0.4), c = 0.4 * a + 0.6 * b + height * Vec3(0.3, -0.2, 0.9);
    for (std::size_t i = 0; i < 300; ++i) {
      const double u = random01(5, 0, i), v = random01(5, 1, i) * (1.0 - u);
      const Vec3 q = a + u * (b - a) + v * (c - a);  // on the triangle
      ASSERT_NEAR((closest_point_on_triangle(q, a, b, c) - q).norm(), 0.0, 1e-14) << height;
    }
  }
}

TEST(TriangleTree, EqualsBruteForce) {
  std::vector<Vec3> queries = test::random_points(300, 1);
  for (std::size_t i = 0; i < 100; ++i) queries[i] = 20.0 * (queries[i] - Vec3(0.5, 0.5, 0.5));
  for (const double size : {0.0, 1e-6, 0.05, 1.0}) expect_exact(random_triangles(700, size, 2), queries, 1e-13);
  for (const std::size_t count : {1, 2, 3, 4, 5, 6, 17}) expect_exact(random_triangles(count, 0.4, 3), queries, 1e-13);
}

TEST(TriangleTree, OnLargeMeshes) {
  const TriangleMesh mesh = mesh_of(testing::sphere(5, 1.0));  // 20,480 triangles: built by several tasks
  std::vector<Vec3> queries = test::random_points(150, 1);
  for (Vec3& q : queries) q = (2.0 * q - Vec3::Ones()) * 1.2;
  expect_exact(mesh, queries, 1e-14);
}

TEST(TriangleTree, TiesGoToTheSmallestIndex) {
  TriangleMesh mesh = mesh_of(testing::sphere(3, 1.0));
  const TriangleTree tree(mesh);
  std::vector<Index> first(mesh.positions.size(), kNoIndex);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) first[v] = std::min(first[v], t);
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (const Index hint : {kNoIndex, Index{0}, Index{1000}, first[v]}) {
      const TriangleTree::Hit hit = tree.closest(mesh.positions[v], hint);
      EXPECT_EQ(hit.distance_sq, 0.0);
      EXPECT_EQ(hit.triangle, first[v]);
    }
  }
  mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  const TriangleTree doubled(mesh);
  for (const Vec3& q : test::random_points(200, 6)) {
    EXPECT_EQ(doubled.closest(q).triangle, tree.closest(q).triangle);
    EXPECT_EQ(doubled.closest(q, 1500).triangle, tree.closest(q).triangle);
  }
}

TEST(TriangleTree, FarOffsetsAndScales) {
  const std::vector<Vec3> base = test::random_points(100, 1);
  for (const double scale : {1e-200, 1e-30, 1e-3, 1e3, 1e30, 1e140}) {
    TriangleMesh mesh = random_triangles(300, 0.1, 2);
    std::vector<Vec3> queries = base;
    for (Vec3& p : mesh.positions) p *= scale;
    for (Vec3& q : queries) q *= scale;
    const TriangleTree tree(mesh), plain(random_triangles(300, 0.1, 2));
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Vec3 found = tree.closest(queries[i]).point;
      ASSERT_NEAR((found / scale - plain.closest(base[i]).point).norm(), 0.0, 1e-13) << scale;
    }
  }
  const Vec3 utm(448262.123, 5411932.678, 512.25);
  TriangleMesh mesh = random_triangles(500, 0.1, 2);
  std::vector<Vec3> queries = base;
  for (Vec3& p : mesh.positions) p += utm;
  for (Vec3& q : queries) q += utm;
  const TriangleTree tree(mesh);
  for (const Vec3& q : queries) {
    EXPECT_NEAR(std::sqrt(tree.closest(q).distance_sq), brute_force_distance(mesh, q), 1e-14);
  }
}

TEST(TriangleTree, PlacesThatSplitBadly) {
  TriangleMesh same = random_triangles(1, 0.5, 2);
  same.triangles.resize(5000, same.triangles[0]);
  TriangleMesh line, shrinking;
  for (Index i = 0; i < 3000; ++i) {
    line.positions.emplace_back(i, 0.0, 0.0);
    const double x = std::exp2(-0.2 * i);
    shrinking.positions.emplace_back(x, 0.5 * x, -x);
    if (i >= 2) line.triangles.push_back({i - 2, i - 1, i});
    if (i >= 2) shrinking.triangles.push_back({i - 2, i - 1, i});
  }
  const std::vector<Vec3> queries = test::random_points(30, 9);
  expect_exact(same, queries, 1e-14);
  expect_exact(shrinking, queries, 1e-14);
  std::vector<Vec3> wide = queries;
  for (Vec3& q : wide) q.x() *= 3000.0;
  expect_exact(line, wide, 1e-12);
  EXPECT_EQ(TriangleTree(same).closest(Vec3(9, 9, 9)).triangle, 0U);
}

TEST(TriangleTree, RefusesWhatIsNoSurface) {
  EXPECT_THROW(TriangleTree(TriangleMesh{}), InvalidInput);
  TriangleMesh mesh = random_triangles(3, 0.5, 1);
  mesh.triangles[1][2] = 9;
  EXPECT_THROW(TriangleTree{mesh}, InvalidInput);
  mesh.triangles[1][2] = 5;
  mesh.positions.emplace_back(std::nan(""), 0.0, 0.0);  // nobody's corner
  EXPECT_EQ(TriangleTree(mesh).size(), 3U);
  mesh.positions[4].y() = HUGE_VAL;
  EXPECT_THROW(TriangleTree{mesh}, InvalidInput);
  EXPECT_EQ(TriangleTree().size(), 0U);
  EXPECT_THROW((void)TriangleTree().closest(Vec3::Zero()), InvalidInput);
}

TEST(TriangleTree, AQueryThatIsNoPointHasNoAnswer) {
  const TriangleTree tree(mesh_of(testing::sphere(1, 1.0)));
  for (const Index hint : {kNoIndex, Index{3}}) {
    const TriangleTree::Hit hit = tree.closest(Vec3(0.0, std::nan(""), 0.0), hint);
    EXPECT_EQ(hit.triangle, kNoIndex);
    EXPECT_TRUE(std::isnan(hit.distance_sq));
  }
}

TEST(TriangleTree, DoesNotDependOnThreads) {
  const TriangleMesh mesh = mesh_of(testing::sphere(6, 1.0, 0.3));
  const std::vector<Vec3> queries = test::random_points(20000, 1);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    std::vector<double> numbers;
    for (const TriangleTree::Hit& hit : TriangleTree(mesh, context).closest(queries, context)) {
      numbers.insert(numbers.end(), {hit.distance_sq, hit.point.x(), static_cast<double>(hit.triangle)});
    }
    return numbers;
  });
}

}  // namespace
}  // namespace shapelight
