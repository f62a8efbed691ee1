#include "shapelight/sample/covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "shapelight/core/error.hpp"
#include "shapelight/sample/random.hpp"
#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

/// A plane with a cross of two small grooves: only their walls hold it against sliding and turning.
SurfaceGraph grooved_plane() {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      positions.emplace_back(x / 50.0 - 1.0 + 1e-4 * random01(1, x, y), y / 50.0 - 1.0 + 1e-4 * random01(2, x, y), 0.0);
      const double side = (x + y) % 2 == 0 ? 1.0 : -1.0;
      normals.push_back(x == 50   ? Vec3(side, 0, 1).normalized()
                        : y == 50 ? Vec3(0, side, 1).normalized()
                                  : Vec3::UnitZ());
    }
  }
  return test::point_graph(positions, normals);
}

/// Smallest by largest eigenvalue of the point-to-plane constraints, about the centre of the whole graph.
double stability(const SurfaceGraph& graph, const std::vector<Index>& vertices) {
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  for (const Index v : vertices) {
    Eigen::Matrix<double, 6, 1> constraint;
    constraint << graph.position[v].cross(graph.normal[v]), graph.normal[v];
    covariance += constraint * constraint.transpose();
  }
  const auto values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(covariance).eigenvalues();
  return values[0] / values[5];
}

TEST(CovarianceSampling, HoldsAGroovedPlaneMuchBetterThanRandom) {
  const SurfaceGraph graph = grooved_plane();
  const std::vector<Index> all = test::all_vertices(graph);
  const double chosen = stability(graph, sample_covariance(graph, all, {.count = 300}));
  const double random = stability(graph, sample_random(graph, all, {.count = 300}));
  EXPECT_GT(chosen, 10.0 * random);
  EXPECT_GT(chosen, 0.1);
}

TEST(CovarianceSampling, IsARanking) {
  const SurfaceGraph graph = test::ellipsoid_graph(500);
  const std::vector<Index> all = test::all_vertices(graph);
  const std::vector<Index> large = sample_covariance(graph, all, {.count = 300});
  const std::vector<Index> small = sample_covariance(graph, all, {.count = 70});
  EXPECT_TRUE(std::equal(small.begin(), small.end(), large.begin()));
}

TEST(CovarianceSampling, VerticesWithoutNormalComeLast) {
  SurfaceGraph graph = test::ellipsoid_graph(40);
  for (std::size_t i = 0; i < 10; ++i) graph.normal[i] = Vec3::Zero();
  const std::vector<Index> chosen = sample_covariance(graph, test::all_vertices(graph), {.count = 40});
  for (std::size_t k = 0; k < 40; ++k) EXPECT_EQ(chosen[k] < 10, k >= 30) << k;
}

TEST(CovarianceSampling, RefusesPointsWithoutAnyNormal) {
  const SurfaceGraph graph = test::point_graph(test::ellipsoid_graph(5).position, std::vector<Vec3>(5, Vec3::Zero()));
  EXPECT_THROW((void)sample_covariance(graph, test::all_vertices(graph), {.count = 2}), InvalidInput);
}

}  // namespace
}  // namespace shapelight
