#include "shapelight/metrics/sampling_quality.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "shapelight/core/error.hpp"
#include "support/random_points.hpp"

namespace shapelight {
namespace {

double nearest_distance(const Vec3& p, const std::vector<Vec3>& others, const Vec3* skip = nullptr) {
  double nearest = HUGE_VAL;
  for (const Vec3& q : others) {
    if (&q != skip) nearest = std::min(nearest, (p - q).norm());
  }
  return nearest;
}

TEST(SamplingQuality, EqualsBruteForce) {
  const std::vector<Vec3> reference = test::random_points(605, 1);
  const std::vector<Vec3> samples = test::random_points(40, 2);
  std::vector<double> importance(605);
  for (std::size_t i = 0; i < 605; ++i) importance[i] = random01(3, 0, i);
  std::vector<Index> order(605);
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return importance[a] > importance[b]; });
  order.resize(61);  // a tenth, rounded up

  double mean = 0.0, max = 0.0, feature_mean = 0.0, feature_max = 0.0, share = 0.0, spacing = 0.0, spacing_sq = 0.0;
  double spacing_min = HUGE_VAL;
  for (Index i = 0; i < 605; ++i) {
    const double d = nearest_distance(reference[i], samples);
    mean += d / 605.0;
    max = std::max(max, d);
    if (std::find(order.begin(), order.end(), i) == order.end()) continue;
    feature_mean += d / 61.0;
    feature_max = std::max(feature_max, d);
  }
  for (const Vec3& p : samples) {
    const double d = nearest_distance(p, samples, &p);
    spacing += d / 40.0;
    spacing_sq += d * d / 40.0;
    spacing_min = std::min(spacing_min, d);
    const double all = nearest_distance(p, reference);
    share += std::any_of(order.begin(), order.end(), [&](Index i) { return (reference[i] - p).norm() == all; }) / 40.0;
  }
  const SamplingQuality quality = measure_sampling(reference, importance, samples);
  EXPECT_NEAR(quality.coverage_mean, mean, 1e-12);
  EXPECT_NEAR(quality.coverage_max, max, 1e-12);
  EXPECT_NEAR(quality.feature_coverage_mean, feature_mean, 1e-12);
  EXPECT_NEAR(quality.feature_coverage_max, feature_max, 1e-12);
  EXPECT_NEAR(quality.feature_share, share, 1e-12);
  EXPECT_NEAR(quality.spacing_mean, spacing, 1e-12);
  EXPECT_NEAR(quality.spacing_min, spacing_min, 1e-12);
  EXPECT_NEAR(quality.spacing_cv, std::sqrt(spacing_sq - spacing * spacing) / spacing, 1e-9);
}

TEST(SamplingQuality, OfALatticeInItself) {
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.emplace_back(0.5 * (i % 10), 0.5 * (i / 10), 0.0);
  const SamplingQuality quality = measure_sampling(points, {}, points);
  EXPECT_EQ(quality.coverage_max, 0.0);
  EXPECT_EQ(quality.spacing_mean, 0.5);
  EXPECT_EQ(quality.spacing_min, 0.5);
  EXPECT_EQ(quality.spacing_cv, 0.0);
  EXPECT_EQ(quality.feature_share, 0.0);
}

TEST(SamplingQuality, SingleAndDuplicateSamples) {
  const std::vector<Vec3> reference{Vec3::Zero(), Vec3(3.0, 4.0, 0.0)};
  const SamplingQuality single =
      measure_sampling(reference, std::vector<double>{1.0, 0.0}, std::vector<Vec3>{Vec3::Zero()});
  EXPECT_EQ(single.coverage_max, 5.0);
  EXPECT_EQ(single.coverage_mean, 2.5);
  EXPECT_EQ(single.feature_coverage_max, 0.0);
  EXPECT_EQ(single.feature_share, 1.0);
  EXPECT_EQ(single.spacing_mean, 0.0);
  const SamplingQuality twice = measure_sampling(reference, {}, std::vector<Vec3>(2, Vec3::Zero()));
  EXPECT_EQ(twice.spacing_min, 0.0);
  EXPECT_EQ(twice.spacing_cv, 0.0);
}

TEST(SamplingQuality, RefusesWhatItCannotMeasure) {
  const std::vector<Vec3> points = test::random_points(5, 1);
  std::vector<Vec3> broken = points;
  broken[3].y() = std::nan("");
  EXPECT_THROW((void)measure_sampling({}, {}, points), InvalidInput);
  EXPECT_THROW((void)measure_sampling(points, {}, {}), InvalidInput);
  EXPECT_THROW((void)measure_sampling(broken, {}, points), InvalidInput);
  EXPECT_THROW((void)measure_sampling(points, {}, broken), InvalidInput);
  EXPECT_THROW((void)measure_sampling(points, std::vector<double>(4, 1.0), points), InvalidInput);
  EXPECT_THROW((void)measure_sampling(points, std::vector<double>(5, std::nan("")), points), InvalidInput);
  EXPECT_THROW((void)surface_variation_knn(broken), InvalidInput);
  EXPECT_THROW((void)surface_variation_knn(points, 2), InvalidInput);
}

TEST(SamplingQuality, DoesNotDependOnThreads) {
  const std::vector<Vec3> reference = test::random_points(20000, 1);
  const std::vector<Vec3> samples = test::random_points(12000, 2);
  const std::vector<double> expected = surface_variation_knn(reference, 10, {.max_threads = 1});
  const SamplingQuality one = measure_sampling(reference, expected, samples, {.max_threads = 1});
  for (const int threads : {2, 3, 8}) {
    EXPECT_EQ(surface_variation_knn(reference, 10, {.max_threads = threads}), expected);
    const SamplingQuality many = measure_sampling(reference, expected, samples, {.max_threads = threads});
    EXPECT_EQ(many.coverage_mean, one.coverage_mean);
    EXPECT_EQ(many.feature_share, one.feature_share);
    EXPECT_EQ(many.spacing_cv, one.spacing_cv);
  }
}

TEST(SurfaceVariation, EqualsBruteForce) {
  const std::vector<Vec3> points = test::random_points(100, 4);
  const std::vector<double> variation = surface_variation_knn(points, 12);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<Vec3> near = points;
    std::sort(near.begin(), near.end(),
              [&](const Vec3& a, const Vec3& b) { return (a - points[i]).norm() < (b - points[i]).norm(); });
    Eigen::Matrix<double, 3, 12> block;
    for (int k = 0; k < 12; ++k) block.col(k) = near[k];
    block.colwise() -= block.rowwise().mean().eval();
    const Vec3 lambda = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block * block.transpose()).eigenvalues();
    EXPECT_NEAR(variation[i], lambda[0] / lambda.sum(), 1e-10);
  }
}

TEST(SurfaceVariation, KnownShapes) {
  std::vector<Vec3> plane;
  for (int i = 0; i < 400; ++i) plane.emplace_back(i % 20 + 1e6, i / 20, 0.0);
  for (const double v : surface_variation_knn(plane)) EXPECT_NEAR(v, 0.0, 1e-12);
  // The corners of an octahedron spread alike along all axes.
  const std::vector<Vec3> octahedron{Vec3::UnitX(),  Vec3::UnitY(),  Vec3::UnitZ(),
                                     -Vec3::UnitX(), -Vec3::UnitY(), -Vec3::UnitZ()};
  for (const double v : surface_variation_knn(octahedron, 6)) EXPECT_NEAR(v, 1.0 / 3.0, 1e-12);
  EXPECT_EQ(surface_variation_knn(std::vector<Vec3>(5, Vec3::Ones())), std::vector<double>(5, 0.0));
  EXPECT_TRUE(surface_variation_knn({}).empty());
}

}  // namespace
}  // namespace shapelight
