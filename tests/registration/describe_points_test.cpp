#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "shapelight/core/error.hpp"
#include "shapelight/registration/coarse_alignment.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kBins = DescribedPoints::kBins;
constexpr std::size_t kMiddle = kBins / 6;  // bin of angle zero, in each third

RegistrationCloud cloud_of(const testing::Shape& shape, double scale = 1.0) {
  std::vector<Vec3> positions = shape.positions;
  for (Vec3& p : positions) p *= scale;
  return RegistrationCloud(positions, shape.normals);
}

RegistrationCloud moved(const testing::Shape& shape, const RigidTransform& T) {
  std::vector<Vec3> positions = shape.positions;
  std::vector<Vec3> normals = shape.normals;
  for (Vec3& p : positions) p = T * p;
  for (Vec3& n : normals) n = T.linear() * n;
  return RegistrationCloud(positions, normals);
}

RigidTransform some_motion() {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  T.translation() = Vec3(3, -1, 2);
  return T;
}

std::vector<Index> all_of(const RegistrationCloud& cloud) {
  std::vector<Index> all(cloud.size());
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

std::vector<double> descriptor(const DescribedPoints& points, std::size_t i) {
  return {points.descriptor.begin() + i * kBins, points.descriptor.begin() + (i + 1) * kBins};
}

std::vector<double> descriptor_at(const DescribedPoints& points, const Vec3& place) {
  return descriptor(points, KdTree(points.position).nearest(place).index);
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  for (std::size_t i = 0; i < kBins; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "bin " << i;
}

TEST(DescribePoints, PlaneIsFlat) {
  const RegistrationCloud cloud = cloud_of(testing::plane(30, 1.0));
  const DescribedPoints points = describe_points(cloud, {}, 2.0);
  ASSERT_GT(points.size(), 100U);
  std::vector<double> expected(kBins, 0.0);
  for (std::size_t angle = 0; angle < 3; ++angle) expected[angle * kBins / 3 + kMiddle] = 2.0;
  for (std::size_t i = 0; i < points.size(); ++i) expect_near(descriptor(points, i), expected, 1e-5);
}

// u = z, direction = x, v = -y, w = x: the first two angles are zero, the third is the tilt.
TEST(DescribePoints, TwoPointsByHand) {
  const double tilt = 2.0 * std::numbers::pi / 11.0;  // the width of a bin
  const RegistrationCloud cloud({{0, 0, 0}, {1.5, 0, 0}}, {{0, 0, 1}, {std::sin(tilt), 0, std::cos(tilt)}});
  const DescribedPoints points = describe_points(cloud, all_of(cloud), 1.0);
  ASSERT_EQ(points.size(), 2U);
  ASSERT_EQ(points.keypoints.size(), 2U);
  // Seen from the other end: u . direction = -sin(tilt); u . n = cos(tilt), w . n = sin(tilt) cos(tilt) / cos(tilt).
  const std::vector<double> found = descriptor_at(points, cloud.position[0]);
  EXPECT_NEAR(found[kMiddle], 2.0, 1e-5);
  const double place = 5.0 - 5.5 * std::sin(tilt);  // in bins, of the second angle seen from the other end
  const auto low = static_cast<std::size_t>(place);
  std::vector<double> second(kBins / 3, 0.0);
  second[kMiddle] += 1.0;
  second[low] += 1.0 - (place - static_cast<double>(low));
  second[low + 1] += place - static_cast<double>(low);
  for (std::size_t b = 0; b < kBins / 3; ++b) EXPECT_NEAR(found[kBins / 3 + b], second[b], 1e-5) << "bin " << b;
  EXPECT_NEAR(found[2 * kBins / 3 + kMiddle + 1], 2.0, 1e-5);
}

TEST(DescribePoints, SphereLooksAlikeEverywhere) {
  const RegistrationCloud cloud = cloud_of(testing::sphere(5, 1.0));
  const DescribedPoints points = describe_points(cloud, {}, coarse_spacing(cloud));
  std::vector<double> mean(kBins, 0.0);
  for (std::size_t i = 0; i < points.descriptor.size(); ++i) {
    mean[i % kBins] += points.descriptor[i] / static_cast<double>(points.size());
  }
  for (std::size_t i = 0; i < points.size(); ++i) expect_near(descriptor(points, i), mean, 0.1);
}

TEST(DescribePoints, TurnedNormalsMirrorTheSecondAndThirdAngle) {
  testing::Shape shape = testing::height_field("ridge", 20, 1.0, 0.15, -0.05, 0.2);
  const DescribedPoints up = describe_points(cloud_of(shape), {}, 1.5);
  for (Vec3& n : shape.normals) n = -n;
  const DescribedPoints down = describe_points(cloud_of(shape), {}, 1.5);
  for (const Vec3& p : up.position) {
    std::vector<double> mirrored = descriptor_at(down, p);
    std::reverse(mirrored.begin() + kBins / 3, mirrored.begin() + 2 * kBins / 3);
    std::reverse(mirrored.begin() + 2 * kBins / 3, mirrored.end());
    expect_near(descriptor_at(up, p), mirrored, 1e-4);
  }
}

// Cells so small that every point has its own: thinning then changes nothing.
TEST(DescribePoints, MotionAndUnitsDoNotMatter) {
  const testing::Shape shape = testing::height_field("ridge", 20, 1.0, 0.15, -0.05, 0.2);
  const double spacing = 0.4;
  const DescribedPoints here = describe_points(cloud_of(shape), {}, spacing);
  const DescribedPoints there = describe_points(moved(shape, some_motion()), {}, spacing);
  const DescribedPoints in_mm = describe_points(cloud_of(shape, 1000.0), {}, 1000.0 * spacing);
  ASSERT_EQ(here.size(), shape.positions.size());
  for (const Vec3& p : shape.positions) {
    expect_near(descriptor_at(here, p), descriptor_at(there, some_motion() * p), 1e-4);
    expect_near(descriptor_at(here, p), descriptor_at(in_mm, 1000.0 * p), 1e-4);
  }
}

TEST(DescribePoints, ThinsToTheMeanOfEveryCell) {
  // The middle of the box is the middle of a cell: cells are centred at x = 0, 4, ... for a box from 0 to 8.
  const RegistrationCloud cloud({{0, 0, 0}, {1, 0, 0}, {4, 0, 0}, {8, 0, 0}},
                                {{0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}});
  const DescribedPoints points = describe_points(cloud, std::vector<Index>{1, 0, 3}, 4.0);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_TRUE(points.position[0].isApprox(Vec3(0.5, 0, 0)));
  EXPECT_TRUE(points.normal[0].isApprox(Vec3(0, 1, 1).normalized()));
  EXPECT_EQ(points.keypoints, (std::vector<Index>{0, 2}));
}

TEST(DescribePoints, LeavesOutPointsWithoutNormal) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const RegistrationCloud cloud({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {6, 0, 0}, {6.1, 0, 0}},
                                {{0, 0, 1}, {0, 0, 0}, {nan, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, -1}});
  const DescribedPoints points = describe_points(cloud, all_of(cloud), 0.9);
  EXPECT_EQ(points.size(), 2U) << "nor a cell whose normals cancel";
  EXPECT_EQ(points.keypoints, (std::vector<Index>{0, 1}));
}

TEST(DescribePoints, EmptyAndTiny) {
  EXPECT_EQ(describe_points(RegistrationCloud({}, {}), {}, 1.0).size(), 0U);
  const RegistrationCloud one({{1, 2, 3}}, {{0, 0, 1}});
  const DescribedPoints point = describe_points(one, all_of(one), 1.0);
  EXPECT_EQ(point.size(), 1U);
  EXPECT_TRUE(point.keypoints.empty()) << "nothing around it to know it by";
  EXPECT_EQ(point.descriptor, std::vector<float>(kBins, 0.0F));
  const RegistrationCloud same(std::vector<Vec3>(50, Vec3::Ones()), std::vector<Vec3>(50, Vec3::UnitZ()));
  EXPECT_EQ(describe_points(same, all_of(same), 1.0).size(), 1U);
}

TEST(DescribePoints, RefusesWhatItCannotUse) {
  const RegistrationCloud bare({{0, 0, 0}, {1, 0, 0}});
  EXPECT_THROW(static_cast<void>(describe_points(bare, {}, 1.0)), InvalidInput);
  const RegistrationCloud cloud({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, 0, 1}});
  for (const double spacing : {0.0, -1.0, 1e-9, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    EXPECT_THROW(static_cast<void>(describe_points(cloud, {}, spacing)), InvalidInput) << spacing;
  }
  EXPECT_THROW(static_cast<void>(describe_points(cloud, std::vector<Index>{2}, 1.0)), InvalidInput);
}

TEST(DescribePoints, SameForAnyNumberOfThreads) {
  const RegistrationCloud cloud = cloud_of(testing::height_field("ridge", 60, 1.0, 0.05, -0.02, 0.2));
  testing::expect_same_for_any_number_of_threads(
      [&](const RunContext& context) { return describe_points(cloud, {}, 1.5, context).descriptor; });
}

TEST(CoarseSpacing, LeavesAboutFourThousandPoints) {
  const RegistrationCloud dense = cloud_of(testing::plane(300, 1.0));
  const double spacing = coarse_spacing(dense);
  EXPECT_NEAR(static_cast<double>(describe_points(dense, {}, spacing).size()), 4000.0, 400.0);
  EXPECT_NEAR(coarse_spacing(cloud_of(testing::plane(300, 1.0), 1000.0)), 1000.0 * spacing, 20.0 * spacing);
}

TEST(CoarseSpacing, NeverBelowTwiceTheScans) {
  const RegistrationCloud sparse = cloud_of(testing::plane(30, 1.0));
  EXPECT_DOUBLE_EQ(coarse_spacing(sparse), 2.0 * sparse.spacing);
  EXPECT_EQ(coarse_spacing(RegistrationCloud({})), 0.0);
  EXPECT_EQ(coarse_spacing(RegistrationCloud(std::vector<Vec3>(5, Vec3::Ones()))), 0.0);
}

}  // namespace
}  // namespace shapelight
