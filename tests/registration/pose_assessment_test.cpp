#include "shapelight/registration/pose_assessment.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "registration/sight.hpp"
#include "registration/surface_pairs.hpp"
#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

RegistrationCloud cloud_of(const testing::Shape& shape) { return RegistrationCloud(shape.positions, shape.normals); }

RigidTransform motion(double angle, const Vec3& axis, const Vec3& shift) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  T.translation() = shift;
  return T;
}

RegistrationCloud moved(const RegistrationCloud& cloud, const RigidTransform& T) {
  std::vector<Vec3> position, normal;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    position.push_back(T * cloud.position[i]);
    normal.push_back(T.linear() * cloud.normal[i]);
  }
  return RegistrationCloud(position, normal);
}

// Every point has itself as its partner: no error at all, and everything overlaps.
TEST(PoseAssessment, AnExactPoseHasNoError) {
  const RegistrationCloud target = cloud_of(testing::torus(60, 30, 1.0, 0.4));
  const RigidTransform T_source_target = motion(1.0, {1, 2, 3}, {4, 5, 6});
  const PoseAssessment pose = assess_pose(moved(target, T_source_target), target, T_source_target.inverse());
  EXPECT_EQ(pose.reciprocal.pairs, target.size());
  EXPECT_DOUBLE_EQ(pose.reciprocal.share, 1.0);
  EXPECT_LT(pose.reciprocal.mean, 1e-12);
  EXPECT_LT(pose.residual, 1e-12);
  EXPECT_DOUBLE_EQ(pose.overlap, 1.0);
  EXPECT_DOUBLE_EQ(pose.normal_agreement, 1.0);
}

// Two planes one above the other by h: every reciprocal distance is h.
TEST(PoseAssessment, ReciprocalErrorOfLiftedPlanes) {
  const RegistrationCloud plane = cloud_of(testing::plane(30, 0.1));
  const double lift = 0.02;
  const PoseAssessment pose = assess_pose(plane, plane, motion(0.0, {0, 0, 1}, {0, 0, lift}));
  EXPECT_EQ(pose.reciprocal.pairs, plane.size());
  EXPECT_NEAR(pose.reciprocal.mean, lift, 1e-12);
  EXPECT_NEAR(pose.reciprocal.std, 0.0, 1e-8);
}

// The second source point is nearest to the first target point, which has a nearer one.
TEST(PoseAssessment, CorrespondencesAreReciprocal) {
  const Vec3 up(0, 0, 1);
  const RegistrationCloud source({{0, 0, 0}, {0.2, 0, 0}, {1, 0, 0}, {2, 1, 0}}, {up, up, up, up});
  const RegistrationCloud target({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}}, {up, up, up});
  const PoseAssessment pose = assess_pose(source, target, RigidTransform::Identity());
  EXPECT_EQ(pose.reciprocal.pairs, 3u);
  EXPECT_DOUBLE_EQ(pose.reciprocal.share, 0.75);
  EXPECT_DOUBLE_EQ(pose.reciprocal.mean, 0.0);
}

// A plane slides along itself and turns about its normal; a sphere turns about anything; a cylinder does both about its
// axis. Two of them as one rigid body hold each other.
TEST(PoseAssessment, NamesWhatTheSurfaceDoesNotDetermine) {
  const RigidTransform here = RigidTransform::Identity();
  const RegistrationCloud plane = cloud_of(testing::plane(30, 0.1));
  EXPECT_LT(assess_pose(plane, plane, here).conditioning, 1e-9);

  const RegistrationCloud sphere = cloud_of(testing::sphere(4, 1.0));
  const PoseAssessment on_sphere = assess_pose(sphere, sphere, here);
  EXPECT_LT(on_sphere.conditioning, 1e-9);
  EXPECT_EQ(on_sphere.weakest.name.substr(0, 13), "turning about");

  const RegistrationCloud torus = cloud_of(testing::torus(60, 30, 1.0, 0.4));
  const PoseAssessment on_torus = assess_pose(torus, torus, here);
  EXPECT_LT(on_torus.conditioning, 1e-9);
  EXPECT_EQ(on_torus.weakest.name, "turning about (0.00, 0.00, 1.00)");

  // A ridge along x, y = |z| like: free along x only.
  std::vector<Vec3> position, normal;
  for (int i = 0; i < 40; ++i) {
    for (int j = -20; j <= 20; ++j) {
      position.push_back({0.05 * i, 0.05 * j, 0.4 * std::sin(0.05 * j)});
      normal.push_back(Vec3(0.0, -0.4 * std::cos(0.05 * j), 1.0).normalized());
    }
  }
  const RegistrationCloud ridge(position, normal);
  EXPECT_EQ(assess_pose(ridge, ridge, here).weakest.name, "sliding along (1.00, 0.00, 0.00)");

  const RegistrationCloud saddle = cloud_of(testing::saddle(40, 0.05));
  EXPECT_GT(assess_pose(saddle, saddle, here).conditioning, 1e-3);
}

// The covariance about the target's origin, moved to the middle of the overlap, has the weakest direction's
// uncertainty.
TEST(PoseAssessment, CovarianceIsThatOfAMotionAboutTheOrigin) {
  const testing::Shape noisy = testing::with_noise(testing::saddle(40, 0.05), 1e-3);
  const testing::Shape exact = testing::saddle(40, 0.05);
  const RegistrationCloud source = cloud_of(noisy);
  const RegistrationCloud target = cloud_of(exact);
  const PoseAssessment near = assess_pose(source, target, RigidTransform::Identity());
  const RigidTransform away = motion(0.0, {0, 0, 1}, {100.0, 0.0, 0.0});
  const PoseAssessment far = assess_pose(moved(source, away), moved(target, away), RigidTransform::Identity());
  // Turning about a far origin moves the points much more, so turn and slide hang together ...
  EXPECT_GT(far.covariance(4, 4), 100.0 * near.covariance(4, 4));
  // ... but the turn alone is as certain as before.
  EXPECT_NEAR(far.covariance(0, 0), near.covariance(0, 0), 1e-6 * near.covariance(0, 0));
  // About the other origin a turn w takes along a slide of away x w.
  Matrix6 carried = Matrix6::Identity();
  carried(4, 2) = -100.0;
  carried(5, 1) = 100.0;
  const Matrix6 expected = carried * near.covariance * carried.transpose();
  EXPECT_LT((far.covariance - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
  EXPECT_NEAR(far.weakest.uncertainty, near.weakest.uncertainty, 1e-6 * near.weakest.uncertainty);
}

TEST(PoseAssessment, NormalsMayPointToEitherSideWithoutASensor) {
  const testing::Shape shape = testing::saddle(40, 0.05);
  std::vector<Vec3> turned = shape.normals;
  for (Vec3& normal : turned) normal = -normal;
  const PoseAssessment pose =
      assess_pose(RegistrationCloud(shape.positions, turned), cloud_of(shape), RigidTransform::Identity());
  EXPECT_DOUBLE_EQ(pose.overlap, 1.0);
}

// Surfaces that pass through each other at an angle fill any gate; those that are the same do not.
TEST(PoseAssessment, TheGateShrinksToTheNoiseOnARightPoseOnly) {
  const RegistrationCloud target = cloud_of(testing::saddle(80, 0.025));
  const RegistrationCloud source = cloud_of(testing::with_noise(testing::saddle(80, 0.025), 1e-3));
  const PoseAssessment right = assess_pose(source, target, RigidTransform::Identity());
  EXPECT_NEAR(right.residual, 1e-3, 3e-4);
  const PoseAssessment wrong = assess_pose(source, target, motion(0.3, {1, 0, 0}, {0, 0, 0}));
  EXPECT_GT(wrong.residual, 10.0 * right.residual);
  EXPECT_LT(wrong.overlap, 0.5 * right.overlap);
}

// A wall seen from the origin: a point before it is in free space, one behind it or beside it is not.
TEST(Sight, FreeSpaceIsWhatLiesBeforeTheNearest) {
  std::vector<Vec3> wall;
  for (int i = -20; i <= 20; ++i) {
    for (int j = -20; j <= 20; ++j) wall.push_back({0.05 * i, 0.05 * j, 2.0});
  }
  RegistrationCloud cloud(wall);
  cloud.viewpoint = Vec3::Zero();
  const registration::Sight sight(cloud);
  const auto count = [&](const Vec3& point) {
    return sight.count(std::vector{point}, RigidTransform::Identity(), 0.1, {}).seen_through;
  };
  EXPECT_EQ(count({0.02, 0.01, 1.5}), 1u);
  EXPECT_EQ(count({0.02, 0.01, 1.95}), 0u) << "within the margin";
  EXPECT_EQ(count({0.02, 0.01, 2.5}), 0u) << "behind the wall";
  EXPECT_EQ(count({1.5, 0.0, 0.1}), 0u) << "where nothing was seen";
}

TEST(PoseAssessment, RefusesWhatCannotBeAssessed) {
  const RegistrationCloud good = cloud_of(testing::saddle(10, 0.1));
  EXPECT_THROW((void)assess_pose(RegistrationCloud({}, {}), good, RigidTransform::Identity()), InvalidInput);
  EXPECT_THROW((void)assess_pose(good, RegistrationCloud(good.position), RigidTransform::Identity()), InvalidInput);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(RegistrationCloud({{0, 0, nan}}), InvalidInput);
  EXPECT_THROW(RegistrationCloud({{0, 0, 0}}, {{0, 0, 1}, {0, 0, 1}}), InvalidInput);
}

TEST(PoseAssessment, SameForAnyNumberOfThreads) {
  const RegistrationCloud target = cloud_of(testing::saddle(120, 0.02));
  const RegistrationCloud source = cloud_of(testing::with_noise(testing::saddle(120, 0.02), 1e-3));
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const PoseAssessment pose = assess_pose(source, target, motion(0.01, {1, 1, 0}, {0.01, 0, 0}), {}, context);
    return std::vector{pose.reciprocal.mean, pose.overlap, pose.residual, pose.conditioning, pose.covariance(2, 4)};
  });
}

}  // namespace
}  // namespace shapelight
