#include "shapelight/retinex/retinex.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "core/exponential.hpp"
#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

std::vector<double> random_field(std::size_t n) {
  std::vector<double> field(n);
  for (std::size_t i = 0; i < n; ++i) field[i] = 2.0 * random01(5, 0, i) - 1.0;
  return field;
}

// Eq. 4 to 7 as written, in double precision.
double brute_force_illumination(const SurfaceGraph& graph, const std::vector<double>& field, Index i) {
  RingCollector rings(graph);
  double sum = 0.0, total = 0.0;
  for (const Index j : rings.collect(i, 4, 81)) {
    const double d = (graph.position[j] - graph.position[i]).norm() / (3.0 * graph.mean_edge_length);
    const double difference = 0.5 * (field[j] - field[i]) / 0.15;
    const double w = graph.area[j] * std::exp(-0.5 * d * d) * std::exp(-0.5 * difference * difference);
    sum += w * 0.5 * (field[j] + 1.0);
    total += w;
  }
  return sum / total;
}

TEST(Retinex, AgreesWithTheEquations) {
  const SurfaceGraph graph = graph_of_mesh(plane(14, 0.3, 0.25));
  const std::vector<double> field = random_field(graph.size());
  const RetinexResult found = decompose_retinex(graph, field);
  for (Index i = 0; i < graph.size(); ++i) {
    const double expected = brute_force_illumination(graph, field, i);
    EXPECT_NEAR(found.illumination[i], expected, 1e-5);
    EXPECT_NEAR(found.reflectance[i], std::log(0.5 * (field[i] + 1.0) + 1.0) - std::log(expected + 1.0), 1e-5);
  }
}

TEST(Retinex, AConstantFieldHasNoDetail) {
  const SurfaceGraph graph = graph_of_mesh(sphere(3, 1.0, 0.2));
  for (const double value : {-1.0, -0.3, 0.0, 1.0}) {
    for (const double r : decompose_retinex(graph, std::vector<double>(graph.size(), value)).reflectance)
      EXPECT_NEAR(r, 0.0, 1e-15);
  }
}

TEST(Retinex, StaysWithinItsBounds) {
  const SurfaceGraph graph = graph_of_mesh(sphere(3, 1.0, 0.2));
  std::vector<double> field = random_field(graph.size());
  for (double& s : field) s = s > 0.0 ? 1.0 : -1.0;
  RetinexOptions blind;
  blind.range_sigma = 100.0;
  for (const RetinexOptions& options : {RetinexOptions{}, blind}) {
    const RetinexResult found = decompose_retinex(graph, field, options);
    for (std::size_t i = 0; i < graph.size(); ++i) {
      EXPECT_GE(found.illumination[i], 0.0);
      EXPECT_LE(found.illumination[i], 1.0);
      EXPECT_LE(std::abs(found.reflectance[i]), std::numbers::ln2);
    }
  }
}

TEST(Retinex, KeepsAStepInTheIlluminationAndPutsTextureIntoTheReflectance) {
  const SurfaceGraph graph = graph_of_mesh(plane(30, 1.0));
  std::vector<double> field(graph.size());
  for (std::size_t i = 0; i < field.size(); ++i)
    field[i] = (i % 30 < 15 ? -0.8 : 0.8) + 0.1 * (i % 2 == 0 ? 1.0 : -1.0);
  const RetinexResult found = decompose_retinex(graph, field);
  for (std::size_t i = 0; i < field.size(); ++i) {
    EXPECT_NEAR(found.illumination[i], i % 30 < 15 ? 0.1 : 0.9, 0.04);
    EXPECT_GT(found.reflectance[i] * (i % 2 == 0 ? 1.0 : -1.0), 0.0);
  }
}

TEST(Retinex, AWiderSigmaSmoothsMore) {
  const SurfaceGraph graph = graph_of_mesh(plane(40, 1.0));
  const std::vector<double> field = random_field(graph.size());
  double last = 1.0;
  for (const double sigma : {1.0, 3.0, 6.0}) {
    RetinexOptions options;
    options.spatial_sigma = sigma;
    options.range_sigma = 100.0;
    const RetinexResult found = decompose_retinex(graph, field, options);
    double spread = 0.0;
    for (const double l : found.illumination) spread += (l - 0.5) * (l - 0.5);
    EXPECT_LT(spread, 0.5 * last * static_cast<double>(graph.size()));
    last = spread / static_cast<double>(graph.size());
  }
}

TEST(Retinex, DoesNotChangeWithScale) {
  const SurfaceGraph graph = graph_of_mesh(sphere(3, 1.0, 0.2));
  const std::vector<double> field = random_field(graph.size());
  const RetinexResult a = decompose_retinex(graph, field);
  const RetinexResult b = decompose_retinex(moved(graph, Eigen::Matrix3d::Identity(), 1e6, Vec3(1e5, 0, 0)), field);
  for (std::size_t i = 0; i < field.size(); ++i) EXPECT_NEAR(a.reflectance[i], b.reflectance[i], 1e-5);
}

TEST(Retinex, EmptyIsolatedAndBadInput) {
  EXPECT_TRUE(decompose_retinex(isolated(0), {}).reflectance.empty());
  EXPECT_EQ(decompose_retinex(isolated(1), std::vector<double>{0.5}).reflectance, std::vector<double>{0.0});
  EXPECT_THROW(static_cast<void>(decompose_retinex(isolated(1), std::vector<double>{1.5})), InvalidInput);
  EXPECT_THROW(static_cast<void>(decompose_retinex(isolated(2), std::vector<double>{0.5})), InvalidInput);
  RetinexOptions options;
  options.range_sigma = 0.0;
  EXPECT_THROW(static_cast<void>(decompose_retinex(isolated(1), std::vector<double>{0.5}, options)), InvalidInput);
}

TEST(Retinex, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(sphere(5, 1.0));
  const std::vector<double> field = random_field(graph.size());
  expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const RetinexResult found = decompose_retinex(graph, field, {}, context);
    return std::pair(found.illumination, found.reflectance);
  });
}

TEST(ExpMinus, IsTheExponential) {
  for (int i = 0; i <= 8000; ++i) {
    const float x = static_cast<float>(i) * 0.005f;
    EXPECT_NEAR(exp_minus(x) / std::exp(-x), 1.0f, 5e-6f) << x;
  }
}

}  // namespace
}  // namespace shapelight
