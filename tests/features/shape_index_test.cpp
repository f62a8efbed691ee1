#include "shapelight/features/shape_index.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

// Closed-form curvatures on a graph without noise: dome, cup, ridge, rut, saddle, flat.
const Curvatures kForms{{1, -1, 2, 0, 3, 0}, {1, -1, 0, -2, -3, 0}, std::vector<Vec3>(6, Vec3::UnitX())};

SurfaceGraph six_vertices() { return isolated(6); }

ShapeIndexOptions literal() {
  ShapeIndexOptions options;
  options.form = ShapeIndexForm::Literal;
  return options;
}

TEST(ShapeIndex, LiteralFormHasKoenderinksValues) {
  const std::vector<double> s = compute_shape_index(six_vertices(), kForms, 0.0, literal());
  const std::vector<double> expected = {1.0, -1.0, 0.5, -0.5, 0.0, 0.0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(s[i], expected[i], 1e-12) << i;
}

TEST(ShapeIndex, RegularisedFormIsTheFormula) {
  SurfaceGraph graph = six_vertices();
  graph.mean_edge_length = 0.1;
  ShapeIndexOptions options;
  options.curvedness_factor = 0.0;
  const double sigma = 0.02;
  const double eps = 1.5 * sigma / 0.01;  // beats 0.02 / h = 0.2
  const std::vector<double> s = compute_shape_index(graph, kForms, sigma, options);
  for (std::size_t i = 0; i < 6; ++i) {
    const double opening = std::hypot(kForms.k1[i] - kForms.k2[i], eps);
    EXPECT_NEAR(s[i], 2.0 / std::numbers::pi * std::atan((kForms.k1[i] + kForms.k2[i]) / opening), 1e-12) << i;
  }
}

TEST(ShapeIndex, EachTermOfTheRegularisationCanRule) {
  SurfaceGraph graph = six_vertices();
  graph.mean_edge_length = 0.01;
  // Curvednesses 1 1 sqrt2 sqrt2 3 0; the upper median is sqrt 2.
  const auto eps_of = [&](double sigma, const ShapeIndexOptions& options) {
    return 2.0 / std::tan(0.5 * std::numbers::pi * compute_shape_index(graph, kForms, sigma, options)[0]);
  };
  ShapeIndexOptions options;
  EXPECT_NEAR(eps_of(0.0, options), 3.0 * std::numbers::sqrt2, 1e-9);
  options.curvedness_factor = 0.0;
  EXPECT_NEAR(eps_of(0.0, options), 2.0, 1e-9);
  EXPECT_NEAR(eps_of(0.001, options), 15.0, 1e-9);
}

TEST(ShapeIndex, FlatIsZeroUnderNoiseAndASphereKeepsItsSign) {
  const double h = 1.0;
  const SurfaceGraph flat = graph_of_mesh(with_noise(plane(30, h), 0.05 * h));
  const Curvatures bends = estimate_curvatures(flat);
  const std::vector<double> wild = compute_shape_index(flat, bends, 0.05 * h, literal());
  const std::vector<double> calm = compute_shape_index(flat, bends, 0.05 * h);
  double wild_sum = 0.0, calm_sum = 0.0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    wild_sum += std::abs(wild[i]);
    calm_sum += std::abs(calm[i]);
  }
  EXPECT_LT(calm_sum, 0.6 * wild_sum);

  const SurfaceGraph ball = graph_of_mesh(sphere(3, 1.0));
  for (const double s : compute_shape_index(ball, estimate_curvatures(ball), 0.0)) EXPECT_GT(s, 0.3);
}

TEST(ShapeIndex, AnalyticSurfaces) {
  const SurfaceGraph ball = graph_of_mesh(sphere(4, 1.0));
  for (const double s : compute_shape_index(ball, estimate_curvatures(ball), 0.0, literal())) EXPECT_GT(s, 0.95);
  const SurfaceGraph tube = graph_of_mesh(cylinder(48, 30, 1.0));
  const std::vector<double> s = compute_shape_index(tube, estimate_curvatures(tube), 0.0, literal());
  EXPECT_NEAR(s[15 * 48], 0.5, 0.02);
  const SurfaceGraph pass = graph_of_mesh(saddle(41, 0.01));
  EXPECT_NEAR(compute_shape_index(pass, estimate_curvatures(pass), 0.0, literal())[20 * 41 + 20], 0.0, 0.02);
}

TEST(ShapeIndex, EmptyAndIsolated) {
  EXPECT_TRUE(compute_shape_index(isolated(0), {}, 0.0).empty());
  const Curvatures none{{0}, {0}, {Vec3::Zero()}};
  EXPECT_EQ(compute_shape_index(isolated(1), none, 0.0), std::vector<double>{0.0});
}

TEST(ShapeIndex, RefusesWhatItCannotUse) {
  const SurfaceGraph graph = six_vertices();
  Curvatures bad = kForms;
  bad.k2[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(compute_shape_index(graph, bad, 0.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(compute_shape_index(graph, kForms, -1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(compute_shape_index(isolated(5), kForms, 0.0)), InvalidInput);
}

TEST(ShapeIndex, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(sphere(5, 1.0), 0.002));
  const Curvatures bends = estimate_curvatures(graph);
  expect_same_for_any_number_of_threads(
      [&](const RunContext& context) { return compute_shape_index(graph, bends, 0.001, {}, context); });
}

}  // namespace
}  // namespace shapelight
