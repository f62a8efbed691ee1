#include "simplify/sample_block.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/random.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight::simplification {
namespace {

Vec3 random_point(std::uint64_t stream, std::uint64_t id) {
  return {random01(1, 3 * stream, id) - 0.5, random01(1, 3 * stream + 1, id) - 0.5,
          random01(1, 3 * stream + 2, id) - 0.5};
}

void set_sample(SampleBlock& block, std::size_t i, const Vec3& p, const Vec3& normal, float weight, float turn) {
  block.x[i] = static_cast<float>(p[0]);
  block.y[i] = static_cast<float>(p[1]);
  block.z[i] = static_cast<float>(p[2]);
  block.nx[i] = static_cast<float>(normal[0]);
  block.ny[i] = static_cast<float>(normal[1]);
  block.nz[i] = static_cast<float>(normal[2]);
  block.weight[i] = weight;
  block.turn[i] = turn;
}

TEST(SampleBlock, ErrorIsTheWeightedSquaredDistanceFromTheBestTriangle) {
  constexpr std::size_t kSamples = 203, kTriangles = 9;  // no multiple of the lanes
  SampleBlock block;
  block.resize(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) set_sample(block, i, random_point(0, i), Vec3::Zero(), 2.0F, 0.0F);
  block.reset();
  double expected_total = 0.0;
  std::vector<double> least(kSamples, std::numeric_limits<double>::infinity());
  std::vector<std::int32_t> best(kSamples, -1);
  for (std::size_t t = 0; t < kTriangles; ++t) {
    const Vec3 a = random_point(1, t), b = random_point(2, t), c = random_point(3, t);
    block.offer({a, b, c}, static_cast<std::int32_t>(t));
    for (std::size_t i = 0; i < kSamples; ++i) {
      const Vec3 p(block.x[i], block.y[i], block.z[i]);
      const double error = 2.0 * (closest_point_on_triangle(p, a, b, c) - p).squaredNorm();
      if (error < least[i]) {
        least[i] = error;
        best[i] = static_cast<std::int32_t>(t);
      }
    }
  }
  for (std::size_t i = 0; i < kSamples; ++i) {
    EXPECT_NEAR(block.error[i], least[i], 1e-6) << i;
    EXPECT_EQ(block.best[i], best[i]) << i;
    expected_total += least[i];
  }
  EXPECT_NEAR(block.total(), expected_total, 1e-4);
}

TEST(SampleBlock, TurnOfTheNormalCountsWhereThereIsOne) {
  SampleBlock block;
  block.resize(2);
  set_sample(block, 0, {0.2, 0.2, 0.0}, Vec3::UnitX(), 1.0F, 0.5F);  // at a right angle to the triangle
  set_sample(block, 1, {0.2, 0.2, 0.0}, Vec3::Zero(), 1.0F, 0.0F);
  block.reset();
  block.offer({Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()}, 0);
  EXPECT_FLOAT_EQ(block.error[0], 0.5F);
  EXPECT_FLOAT_EQ(block.error[1], 0.0F);
}

TEST(SampleBlock, TriangleWithoutAreaIsPassedOver) {
  SampleBlock block;
  block.resize(1);
  set_sample(block, 0, {0.5, 1.0, 0.0}, Vec3::Zero(), 1.0F, 0.0F);
  block.reset();
  block.offer({Vec3::Zero(), Vec3::UnitX(), 0.5 * Vec3::UnitX()}, 0);
  EXPECT_EQ(block.best[0], -1);
}

TEST(LocalTriangle, QualityIsThatOfTheEquilateralOneAtMost) {
  EXPECT_NEAR(LocalTriangle(Vec3::Zero(), Vec3::UnitX(), {0.5, std::sqrt(0.75), 0.0}).quality(), std::sqrt(0.75),
              1e-12);
  EXPECT_NEAR(LocalTriangle(Vec3::Zero(), Vec3::UnitX(), {0.5, 1e-3, 0.0}).quality(), 1e-3, 1e-12);
  EXPECT_EQ(LocalTriangle(Vec3::Zero(), Vec3::Zero(), Vec3::Zero()).quality(), 0.0);
}

}  // namespace
}  // namespace shapelight::simplification
