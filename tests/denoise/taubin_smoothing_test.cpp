#include "shapelight/denoise/taubin_smoothing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "shapelight/core/error.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

SurfaceGraph graph_of(const Shape& shape) { return graph_from_mesh(shape.positions, shape.triangles).graph; }

// Root mean square of the distance to the unit sphere about `center`.
double roughness(const std::vector<Vec3>& positions, const Vec3& center) {
  double mean = 0.0, square = 0.0;
  for (const Vec3& p : positions) mean += (p - center).norm() / static_cast<double>(positions.size());
  for (const Vec3& p : positions) square += std::pow((p - center).norm() - mean, 2) / static_cast<double>(positions.size());
  return std::sqrt(square);
}

TEST(TaubinSmoothing, TakesNoiseOutAndKeepsTheVolume) {
  const Shape clean = sphere(4, 1.0, 0.2);
  const SurfaceGraph smooth_in = graph_of(clean);
  const double sigma = 0.2 * smooth_in.mean_edge_length;
  const SurfaceGraph noisy = graph_of(with_noise(clean, sigma));
  EXPECT_LT(roughness(smooth_positions(noisy), -noisy.origin), 0.35 * sigma);
  double radius = 0.0;
  for (const Vec3& p : smooth_positions(smooth_in)) radius += (p + smooth_in.origin).norm() / static_cast<double>(smooth_in.size());
  EXPECT_NEAR(radius, 1.0, 0.01);
}

TEST(TaubinSmoothing, BordersStayBordersAndIsolatedVerticesStay) {
  Shape flat = plane(16, 1.0, 0.2);
  flat.positions.emplace_back(0.0, 0.0, 9.0);  // in no face
  const SurfaceGraph graph = graph_of(flat);
  const std::vector<Vec3> moved = smooth_positions(graph);
  for (std::size_t v = 0; v < graph.size(); ++v) {
    if (graph.neighbors_of(v).empty()) {
      EXPECT_EQ(moved[v], graph.position[v]);
    } else {
      EXPECT_NEAR((moved[v] + graph.origin).z(), 0.0, 1e-12) << "in its plane";
      EXPECT_LT((moved[v] - graph.position[v]).norm(), 1.0) << "near its place: the border does not creep inwards";
    }
  }
}

TEST(TaubinSmoothing, NoStepsNoChange) {
  const SurfaceGraph graph = graph_of(sphere(2, 1.0));
  EXPECT_EQ(smooth_positions(graph, {.iterations = 0}), graph.position);
  EXPECT_TRUE(smooth_positions(SurfaceGraph{}).empty());
  EXPECT_THROW((void)smooth_positions(graph, {.iterations = -1}), InvalidInput);
  EXPECT_THROW((void)smooth_positions(graph, {.shrink = 2.0}), InvalidInput);
}

TEST(TaubinSmoothing, SameForAnyNumberOfThreads) {
  const SurfaceGraph graph = graph_of(with_noise(sphere(5, 1.0), 0.01));
  expect_same_for_any_number_of_threads([&](const RunContext& context) { return smooth_positions(graph, {}, context); });
}

}  // namespace
}  // namespace shapelight
