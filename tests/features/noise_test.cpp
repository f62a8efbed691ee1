#include "shapelight/features/noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/determinism.hpp"
#include "support/graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

std::vector<Shape> shapes() {
  return {plane(45, 1.0, 0.2), sphere(4, 1.0, 0.2), torus(90, 40, 2.0, 0.7), saddle(45, 0.03, 0.2)};
}

TEST(Noise, FindsTheKnownNoise) {
  for (const Shape& shape : shapes()) {
    const double h = graph_of_mesh(shape).mean_edge_length;
    for (const double share : {0.02, 0.05, 0.1, 0.2}) {
      const Shape noisy = with_noise(shape, share * h);
      EXPECT_NEAR(estimate_noise(graph_of_mesh(noisy)) / (share * h), 1.0, 0.1) << shape.name << " " << share;
    }
    const Shape wild = with_noise(shape, 0.5 * h);
    EXPECT_NEAR(estimate_noise(graph_of_mesh(wild)) / (0.5 * h), 1.0, 0.25) << shape.name;
  }
}

TEST(Noise, FindsItInCloudsToo) {
  const Shape shape = sphere(4, 1.0, 0.2);
  const double h = graph_of_mesh(shape).mean_edge_length;
  EXPECT_NEAR(estimate_noise(graph_of_points(with_noise(shape, 0.1 * h), 12)) / (0.1 * h), 1.0, 0.1);
}

TEST(Noise, CleanSurfacesHaveNearlyNone) {
  for (const Shape& shape : shapes()) {
    const SurfaceGraph graph = graph_of_mesh(shape);
    EXPECT_LT(estimate_noise(graph), 0.005 * graph.mean_edge_length) << shape.name;
  }
}

TEST(Noise, ScalesWithTheSurface) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(sphere(3, 1.0), 0.01));
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(0.7, Vec3(1, 1, 2).normalized()).toRotationMatrix();
  const double sigma = estimate_noise(graph);
  EXPECT_NEAR(estimate_noise(moved(graph, rotation, 250.0, Vec3(1, 2, 3))), 250.0 * sigma, 1e-6 * sigma * 250.0);
}

TEST(Noise, StraysDoNotCount) {
  Shape shape = with_noise(plane(45, 1.0), 0.05);
  for (std::size_t i = 0; i < shape.positions.size(); i += 50) shape.positions[i].z() += 30.0;
  EXPECT_LT(estimate_noise(graph_of_mesh(shape)), 0.2);
}

TEST(Noise, TooFewVerticesGiveZero) {
  EXPECT_EQ(estimate_noise(isolated(0)), 0.0);
  EXPECT_EQ(estimate_noise(isolated(5)), 0.0);
  // A bump amid seven vertices: only one more point than the quadric has freedoms.
  std::vector<Vec3> fan = {{0, 0, 0.5}};
  std::set<std::pair<Index, Index>> spokes;
  for (Index i = 1; i < 8; ++i) {
    fan.emplace_back(std::cos(0.9 * i), std::sin(0.9 * i), 0.1 * (i % 3));
    spokes.emplace(0, i);
  }
  EXPECT_EQ(estimate_noise(graph_of_edges(fan, spokes)), 0.0);
}

TEST(Noise, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(sphere(5, 1.0), 0.002));
  expect_same_for_any_number_of_threads([&](const RunContext& context) { return estimate_noise(graph, context); });
}

}  // namespace
}  // namespace shapelight
