#include "shapelight/graph/build_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "shapelight/core/error.hpp"
#include "support/random_points.hpp"

namespace shapelight {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// (size + 1)^2 vertices in z = 0, two triangles per unit square, seen from +z.
struct Grid {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};
Grid flat_grid(Index size) {
  Grid grid;
  for (Index y = 0; y <= size; ++y) {
    for (Index x = 0; x <= size; ++x) grid.positions.emplace_back(x, y, 0);
  }
  for (Index y = 0; y < size; ++y) {
    for (Index x = 0; x < size; ++x) {
      const Index a = y * (size + 1) + x;
      grid.triangles.push_back({a, a + 1, a + size + 2});
      grid.triangles.push_back({a, a + size + 2, a + size + 1});
    }
  }
  return grid;
}

// The octahedron, wound outwards.
Grid octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

std::vector<Vec3> sphere_points(std::size_t count) {
  std::vector<Vec3> points(count);
  for (std::size_t i = 0; i < count; ++i) {  // Fibonacci lattice
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
    const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(i);
    points[i] = {std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z};
  }
  return points;
}

TEST(GraphFromMesh, FlatGridHasItsAreaNormalsAndBorder) {
  const Grid grid = flat_grid(8);
  const BuiltGraph built = graph_from_mesh(grid.positions, grid.triangles);
  validate(built.graph);
  EXPECT_EQ(built.graph.size(), 81U);
  EXPECT_NEAR(built.graph.total_area, 64.0, 1e-12);
  EXPECT_EQ(built.diagnostics.boundary_vertices, 32U);
  EXPECT_EQ(built.diagnostics.components, 1U);
  EXPECT_EQ(built.diagnostics.non_manifold_edges, 0U);
  EXPECT_NEAR(built.graph.mean_edge_length, (144.0 + 64.0 * std::sqrt(2.0)) / 208.0, 1e-12);
  const Index inner = built.graph.vertex_of_point[4 * 9 + 4];
  EXPECT_EQ(built.graph.neighbors_of(inner).size(), 6U);
  EXPECT_NEAR(built.graph.area[inner], 1.0, 1e-12);
  EXPECT_TRUE(built.graph.normal[inner].isApprox(Vec3::UnitZ()));
  double weights = 0.0;
  for (std::size_t e = built.graph.offsets[inner]; e < built.graph.offsets[inner + 1]; ++e) weights += built.graph.weight[e];
  EXPECT_NEAR(weights, 6.0, 1e-6);
}

TEST(GraphFromMesh, ClosedSurfaceWoundInwardsIsTurnedOutwards) {
  Grid shape = octahedron();
  for (Triangle& t : shape.triangles) std::swap(t[0], t[1]);
  const BuiltGraph built = graph_from_mesh(shape.positions, shape.triangles);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_GT(built.graph.normal[i].dot(built.graph.position[i]), 0.9);
}

TEST(GraphFromMesh, OrderOfInputChangesNothing) {
  const Grid grid = flat_grid(6);
  const auto n = static_cast<Index>(grid.positions.size());
  Grid shuffled;
  for (Index i = 0; i < n; ++i) shuffled.positions.push_back(grid.positions[(i * 10 + 3) % n]);  // 10 and 49 are coprime
  std::vector<Index> place(n);
  for (Index i = 0; i < n; ++i) place[(i * 10 + 3) % n] = i;
  for (auto t = grid.triangles.rbegin(); t != grid.triangles.rend(); ++t) {
    shuffled.triangles.push_back({place[(*t)[1]], place[(*t)[2]], place[(*t)[0]]});
  }
  const SurfaceGraph a = graph_from_mesh(grid.positions, grid.triangles).graph;
  const SurfaceGraph b = graph_from_mesh(shuffled.positions, shuffled.triangles).graph;
  EXPECT_EQ(a.neighbors, b.neighbors);
  EXPECT_EQ(a.weight, b.weight);
  EXPECT_EQ(a.area, b.area);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.position[i], b.position[i]);
    EXPECT_EQ(a.normal[i], b.normal[i]);
  }
}

TEST(GraphFromMesh, OddInputIsCountedAndLeftOut) {
  // A flat square of two triangles; vertex 4 repeats vertex 0, 5 is not finite, 6 is used by nothing, and a third
  // triangle stands on the diagonal, which makes that edge non-manifold.
  const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                       {0, 0, 0}, {kNaN, 0, 0}, {9, 9, 9}, {0.5, 0.5, 1}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {4, 2, 3}, {0, 0, 1}, {0, 4, 1}, {1, 2, 5}, {0, 2, 7}};
  const BuiltGraph built = graph_from_mesh(positions, triangles);
  validate(built.graph);
  EXPECT_EQ(built.graph.size(), 6U);
  EXPECT_EQ(built.diagnostics.non_finite_points, 1U);
  EXPECT_EQ(built.diagnostics.duplicate_points, 1U);
  EXPECT_EQ(built.diagnostics.degenerate_triangles, 2U);
  EXPECT_EQ(built.diagnostics.isolated_vertices, 1U);
  EXPECT_EQ(built.diagnostics.outliers, 1U);
  EXPECT_EQ(built.diagnostics.non_manifold_edges, 1U);
  EXPECT_EQ(built.graph.vertex_of_point[5], kNoIndex);
  EXPECT_EQ(built.graph.vertex_of_point[4], built.graph.vertex_of_point[0]);
  EXPECT_EQ(built.graph.outlier[built.graph.vertex_of_point[6]], 1);
}

TEST(GraphFromMesh, IndexOutOfRangeIsNamed) {
  const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 7}};
  try {
    (void)graph_from_mesh(positions, triangles);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "triangle 0: vertex 7 >= 3 vertices");
  }
}

TEST(GraphFromPoints, SphereIsClosedOrientedOutwardsAndHasItsArea) {
  const std::vector<Vec3> points = sphere_points(4000);
  const BuiltGraph built = graph_from_points(points, std::nullopt);
  validate(built.graph);
  EXPECT_EQ(built.diagnostics.components, 1U);
  EXPECT_EQ(built.diagnostics.boundary_vertices, 0U);
  EXPECT_EQ(built.diagnostics.outliers, 0U);
  for (std::size_t i = 0; i < built.graph.size(); ++i) {
    EXPECT_GT(built.graph.normal[i].dot(built.graph.position[i].normalized()), 0.995);
    EXPECT_GE(built.graph.neighbors_of(i).size(), 12U);
  }
  EXPECT_NEAR(built.graph.total_area, 4.0 * std::numbers::pi, 1.5);
}

TEST(GraphFromPoints, ViewpointDecidesTheSide) {
  const std::vector<Vec3> points = sphere_points(1000);
  const SurfaceGraph inside = graph_from_points(points, Vec3::Zero()).graph;
  for (std::size_t i = 0; i < inside.size(); ++i) EXPECT_LT(inside.normal[i].dot(inside.position[i]), 0.0);
}

TEST(GraphFromPoints, StraysAreFlaggedAndSurfacePointsAreNot) {
  std::vector<Vec3> points = sphere_points(5000);
  const std::vector<Vec3> strays = test::random_points(20, 3);
  for (const Vec3& s : strays) points.push_back(Vec3::Constant(1.5) + 4.0 * s);
  const BuiltGraph built = graph_from_points(points, std::nullopt);
  EXPECT_EQ(built.diagnostics.outliers, 20U);
  for (std::size_t i = 5000; i < points.size(); ++i) EXPECT_EQ(built.graph.outlier[built.graph.vertex_of_point[i]], 1);
}

TEST(GraphFromPoints, AScanThatThinsOutWithRangeHasNoStrays) {
  std::vector<Vec3> points;  // rough ground around a spinning lidar, rings ever farther apart
  for (int ring = 0; ring < 60; ++ring) {
    const double range = std::pow(1.08, ring);
    for (int step = 0; step < 200; ++step) {
      const double angle = 2.0 * std::numbers::pi * (step + 0.5 * random01(5, 0, ring * 200 + step)) / 200.0;
      const double height = 0.3 * range * random01(6, 0, ring * 200 + step);
      points.emplace_back(range * std::cos(angle), range * std::sin(angle), height);
    }
  }
  EXPECT_EQ(graph_from_points(points, std::nullopt).diagnostics.outliers, 0U);
}

TEST(GraphFromPoints, OpenPatchHasABorder) {
  std::vector<Vec3> points;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) points.emplace_back(x + 0.1 * random01(1, 0, y * 20 + x), y + 0.1 * random01(1, 1, y * 20 + x), 0);
  }
  const SurfaceGraph graph = graph_from_points(points, std::nullopt).graph;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::size_t x = p % 20;
    const std::size_t y = p / 20;
    const bool border = x == 0 || y == 0 || x == 19 || y == 19;
    const bool deep = x > 2 && y > 2 && x < 17 && y < 17;
    const bool flagged = graph.boundary[graph.vertex_of_point[p]] == 1;
    EXPECT_TRUE(flagged || !border) << p;
    EXPECT_FALSE(flagged && deep) << p;
  }
}

TEST(GraphFromPoints, EdgeCasesGiveAValidGraph) {
  const std::vector<Vec3> collinear = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  const std::vector<Vec3> same(30, Vec3(1, 2, 3));
  const std::vector<Vec3> invalid = {{kNaN, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0}};
  for (const auto& points : {std::vector<Vec3>{}, std::vector<Vec3>{Vec3(5, 5, 5)}, collinear, same, invalid}) {
    const BuiltGraph built = graph_from_points(points, std::nullopt);
    validate(built.graph);
    EXPECT_LE(built.graph.size(), points.size());
  }
  EXPECT_EQ(graph_from_points(same, std::nullopt).graph.size(), 1U);
  EXPECT_EQ(graph_from_points(invalid, std::nullopt).graph.size(), 0U);
}

// A 40 x 30 depth image of two planes, one half a unit nearer.
Geometry depth_step() {
  Geometry image;
  image.grid = RangeGrid{40, 30, {}};
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 40; ++column) {
      const double z = column < 20 ? 2.0 : 1.5;
      image.grid->pixel.push_back(static_cast<Index>(image.positions.size()));
      image.positions.emplace_back((column - 20) * z / 400, (row - 15) * z / 400, z);
    }
  }
  image.viewpoint = Vec3::Zero();
  return image;
}

TEST(GraphFromRangeImage, DepthJumpsAreCutAndNormalsLookAtTheSensor) {
  const Geometry image = depth_step();
  const BuiltGraph built = build_graph(image);
  validate(built.graph);
  EXPECT_EQ(built.diagnostics.components, 2U);
  EXPECT_EQ(built.diagnostics.boundary_vertices, 2U * (2 * 20 + 2 * 28));
  for (std::size_t i = 0; i < built.graph.size(); ++i) EXPECT_LT(built.graph.normal[i].z(), -0.99);
}

TEST(GraphFromRangeImage, EmptyPixelsMakeHoles) {
  Geometry image = depth_step();
  image.positions[5 * 40 + 5].x() = kNaN;
  const BuiltGraph built = build_graph(image);
  validate(built.graph);
  EXPECT_EQ(built.diagnostics.non_finite_points, 1U);
  EXPECT_GT(built.diagnostics.boundary_vertices, 192U);
}

TEST(BuildGraph, SameForAnyNumberOfThreads) {
  const std::vector<Vec3> points = sphere_points(20000);
  const SurfaceGraph one = graph_from_points(points, std::nullopt, {}, {.max_threads = 1}).graph;
  for (const int threads : {2, 3, 8}) {
    const SurfaceGraph many = graph_from_points(points, std::nullopt, {}, {.max_threads = threads}).graph;
    EXPECT_EQ(one.neighbors, many.neighbors);
    EXPECT_EQ(one.area, many.area);
    EXPECT_EQ(one.boundary, many.boundary);
    EXPECT_TRUE(std::equal(one.normal.begin(), one.normal.end(), many.normal.begin()));
  }
}

TEST(RingCollector, RingsGrowOutwardsAndRespectTheLimit) {
  const Grid grid = flat_grid(10);
  const SurfaceGraph graph = graph_from_mesh(grid.positions, grid.triangles).graph;
  RingCollector rings(graph);
  const Index center = graph.vertex_of_point[5 * 11 + 5];
  EXPECT_EQ(rings.collect(center, 0, 100).size(), 1U);
  EXPECT_EQ(rings.collect(center, 1, 100).size(), 7U);
  EXPECT_EQ(rings.collect(center, 2, 100).size(), 19U);  // hexagonal numbers: 1, 7, 19
  EXPECT_EQ(rings.collect(center, 2, 10).size(), 10U);
  EXPECT_EQ(rings.collect(center, 1, 100).front(), center);
}

}  // namespace
}  // namespace shapelight
