#include "shapelight/features/surface_variation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>

#include "support/determinism.hpp"
#include "support/graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

constexpr SurfaceVariationMethod kMethods[] = {SurfaceVariationMethod::Nearest, SurfaceVariationMethod::Diffusion};

SurfaceVariationOptions with(SurfaceVariationMethod method, int neighbors = 30) { return {method, neighbors}; }

double brute_force(const SurfaceGraph& graph, std::size_t i, std::size_t k) {
  std::vector<std::pair<double, Index>> near;
  for (Index j = 0; j < graph.size(); ++j) near.emplace_back((graph.position[j] - graph.position[i]).squaredNorm(), j);
  std::sort(near.begin(), near.end());
  near.resize(std::min(k, near.size()));
  Vec3 mean = Vec3::Zero();
  for (const auto& [d, j] : near) mean += graph.position[j] / static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [d, j] : near) covariance += (graph.position[j] - mean) * (graph.position[j] - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] / covariance.trace();
}

TEST(SurfaceVariation, NearestAgreesWithBruteForce) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(torus(40, 18, 1.0, 0.4), 0.03));
  const std::vector<double> found = compute_surface_variation(graph);
  for (std::size_t i = 0; i < graph.size(); ++i) EXPECT_NEAR(found[i], brute_force(graph, i, 30), 1e-9);
}

TEST(SurfaceVariation, DiffusionRanksLikeTheNearest) {
  Shape egg = sphere(4, 1.0, 0.2);
  for (Vec3& p : egg.positions) p = p.cwiseProduct(Vec3(1.0, 0.6, 0.3));
  const SurfaceGraph graph = graph_of_points(egg, 12);
  const std::vector<double> exact = compute_surface_variation(graph);
  const std::vector<double> quick = compute_surface_variation(graph, with(SurfaceVariationMethod::Diffusion));
  std::size_t concordant = 0, pairs = 0;
  for (std::size_t i = 0; i < graph.size(); i += 3) {
    for (std::size_t j = 0; j < i; j += 3) {
      ++pairs;
      concordant += (exact[i] < exact[j]) == (quick[i] < quick[j]);
    }
  }
  EXPECT_GT(static_cast<double>(concordant), 0.9 * static_cast<double>(pairs));
}

TEST(SurfaceVariation, PlaneIsZeroAndAnIsotropicCloudAThird) {
  for (const SurfaceVariationMethod method : kMethods) {
    for (const double v : compute_surface_variation(graph_of_mesh(plane(15, 1.0, 0.2)), with(method)))
      EXPECT_LT(v, 1e-12);
  }
  // The corners of a cube about its centre: three equal eigenvalues, where Newton's steps converge slowest.
  std::vector<Vec3> cube = {Vec3::Zero()};
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) cube.emplace_back(x, y, z);
    }
  }
  std::set<std::pair<Index, Index>> spokes;
  for (Index i = 1; i < 9; ++i) spokes.emplace(0, i);
  EXPECT_NEAR(compute_surface_variation(graph_of_edges(cube, spokes))[0], 1.0 / 3.0, 1e-4);
}

TEST(SurfaceVariation, DoesNotChangeWithMotionAndScale) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(torus(30, 16, 1.0, 0.4), 0.01));
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(2.0, Vec3(3, -1, 2).normalized()).toRotationMatrix();
  const SurfaceGraph other = moved(graph, rotation, 0.001, Vec3(0.001, 0.002, 0));
  for (const SurfaceVariationMethod method : kMethods) {
    const std::vector<double> a = compute_surface_variation(graph, with(method));
    const std::vector<double> b = compute_surface_variation(other, with(method));
    for (std::size_t i = 0; i < graph.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-8);
  }
}

TEST(SurfaceVariation, EmptyIsolatedAndCollinear) {
  for (const SurfaceVariationMethod method : kMethods) {
    EXPECT_TRUE(compute_surface_variation(isolated(0), with(method)).empty());
    EXPECT_EQ(compute_surface_variation(isolated(4), with(method)), std::vector<double>(4, 0.0));
    const std::vector<Vec3> line = {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}};
    for (const double v : compute_surface_variation(graph_of_edges(line, {{0, 1}, {1, 2}}), with(method)))
      EXPECT_EQ(v, 0.0);
  }
}

TEST(SurfaceVariation, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(sphere(5, 1.0), 0.002));
  for (const SurfaceVariationMethod method : kMethods) {
    expect_same_for_any_number_of_threads(
        [&](const RunContext& context) { return compute_surface_variation(graph, with(method), context); });
  }
}

}  // namespace
}  // namespace shapelight
