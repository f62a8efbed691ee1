#include "shapelight/registration/icp.hpp"

#include <gtest/gtest.h>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/registration_clouds.hpp"

namespace shapelight {
namespace {

using testing::motion;
using testing::moved;
using testing::rotation_between;
using testing::turned;

const RigidTransform kPose = motion(0.12, Vec3(1, 2, 3), Vec3(0.05, -0.03, 0.04));

IcpOptions with_metric(IcpMetric metric) {
  IcpOptions options;
  options.metric = metric;
  return options;
}

class IcpMetrics : public ::testing::TestWithParam<IcpMetric> {};
INSTANTIATE_TEST_SUITE_P(All, IcpMetrics, ::testing::Values(IcpMetric::Point, IcpMetric::Plane, IcpMetric::Gicp),
                         [](const auto& metric) { return std::string(enum_name(metric.param)); });

TEST_P(IcpMetrics, FindsThePoseOfTheSamePoints) {
  const testing::Sheet sheet = testing::wavy_sheet(1500, 1);
  const RegistrationCloud source(sheet.positions, sheet.normals);
  const RegistrationCloud target(moved(sheet.positions, kPose), turned(sheet.normals, kPose));
  const RegistrationResult result =
      register_by_icp(source, target, RigidTransform::Identity(), with_metric(GetParam()));
  EXPECT_TRUE(result.converged()) << stop_reason_name(result.stop);
  EXPECT_LT(rotation_between(result.T_target_source, kPose), 1e-6);
  EXPECT_LT((result.T_target_source.translation() - kPose.translation()).norm(), 1e-6);
  EXPECT_EQ(result.inlier_ratio, 1.0);
  EXPECT_LT(result.rms, 1e-6);
  EXPECT_EQ(result.error.size(), result.iterations);
}

TEST_P(IcpMetrics, IsTheSameInOtherUnits) {
  const testing::Sheet a = testing::wavy_sheet(800, 1), b = testing::wavy_sheet(900, 2);
  const auto pose_at = [&](double unit) {
    std::vector<Vec3> from = a.positions, to = moved(b.positions, kPose);
    for (Vec3& p : from) p *= unit;
    for (Vec3& p : to) p *= unit;
    RigidTransform T =
        register_by_icp(RegistrationCloud(from, a.normals), RegistrationCloud(to, turned(b.normals, kPose)),
                        RigidTransform::Identity(), with_metric(GetParam()))
            .T_target_source;
    T.translation() /= unit;
    return T;
  };
  EXPECT_NEAR((pose_at(1000.0).matrix() - pose_at(1.0).matrix()).norm(), 0.0, 1e-9);
}

TEST_P(IcpMetrics, SameForAnyNumberOfThreads) {
  const testing::Sheet a = testing::wavy_sheet(9000, 1), b = testing::wavy_sheet(9000, 2);
  const RegistrationCloud source(a.positions, a.normals);
  const RegistrationCloud target(moved(b.positions, kPose), turned(b.normals, kPose));
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    IcpOptions options = with_metric(GetParam());
    options.max_iterations = 8;
    const RegistrationResult result = register_by_icp(source, target, RigidTransform::Identity(), options, context);
    return std::make_pair(Eigen::Matrix4d(result.T_target_source.matrix()), result.error);
  });
}

TEST_P(IcpMetrics, OpenCloudsGiveFinitePosesAndNoWildMotion) {
  const RigidTransform start = motion(0.05, Vec3(1, 1, 0), Vec3(0.02, 0.01, 0.03));
  for (const testing::OpenCloud& from : testing::open_clouds()) {
    for (const testing::OpenCloud& to : testing::open_clouds()) {
      IcpOptions options = with_metric(GetParam());
      options.max_distance = 5.0;
      const RegistrationResult result = register_by_icp(RegistrationCloud(from.positions, from.normals),
                                                        RegistrationCloud(to.positions, to.normals), start, options);
      EXPECT_TRUE(result.T_target_source.matrix().allFinite()) << from.name << " " << to.name;
      EXPECT_LT(result.T_target_source.translation().norm(), 10.0) << from.name << " " << to.name;
      EXPECT_NEAR(result.T_target_source.linear().determinant(), 1.0, 1e-9);
      EXPECT_TRUE(std::isfinite(result.rms));
    }
  }
}

TEST_P(IcpMetrics, ComesToRestOnRealScans) {
  const testing::ScanPair scans = testing::dragon_pair(40);
  // Normals are not the point here: any will do for coming to rest.
  const RegistrationCloud source(scans.source, std::vector<Vec3>(scans.source.size(), Vec3::UnitZ()));
  const RegistrationCloud target(scans.target, std::vector<Vec3>(scans.target.size(), Vec3::UnitZ()));
  EXPECT_TRUE(register_by_icp(source, target, scans.T_target_source, with_metric(GetParam())).converged());
}

// Sparse sheets whose pairs would change back and forth for ever, under every eighth seed or so.
TEST(Icp, ComesToRestWherePairsAlternate) {
  IcpOptions options = with_metric(IcpMetric::Plane);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const testing::Sheet a = testing::wavy_sheet(100, seed), b = testing::wavy_sheet(100, seed + 1000);
    const RegistrationCloud source(a.positions, a.normals), target(b.positions, b.normals);
    EXPECT_TRUE(register_by_icp(source, target, motion(0.1, Vec3(1, 2, 3), Vec3(0.1, 0, 0.05)), options).converged())
        << seed;
  }
}

TEST(Icp, GicpCostIsThatOfTheCovariances) {
  const testing::Sheet a = testing::wavy_sheet(60, 1), b = testing::wavy_sheet(60, 2);
  IcpOptions options = with_metric(IcpMetric::Gicp);
  options.max_distance = 10.0;
  options.max_iterations = 1;
  const double error = register_by_icp(RegistrationCloud(a.positions, a.normals),
                                       RegistrationCloud(b.positions, b.normals), kPose, options)
                           .error.front();
  const auto covariance = [](const Vec3& n) {
    return Eigen::Matrix3d(Eigen::Matrix3d::Identity() - (1.0 - 1e-3) * n * n.transpose());
  };
  const Eigen::Matrix3d R = kPose.linear();
  double sum = 0.0;
  for (std::size_t i = 0; i < 60; ++i) {
    const Vec3 x = kPose * a.positions[i];
    std::size_t best = 0;
    for (std::size_t j = 1; j < 60; ++j) {
      if ((x - b.positions[j]).squaredNorm() < (x - b.positions[best]).squaredNorm()) best = j;
    }
    const Vec3 r = x - b.positions[best];
    const Eigen::Matrix3d both = covariance(b.normals[best]) + R * covariance(a.normals[i]) * R.transpose();
    sum += r.dot(both.inverse() * r);
  }
  EXPECT_NEAR(error, std::sqrt(sum / 60.0), 1e-9 * error);
}

TEST(Icp, FarPairsHaveNoSay) {
  testing::Sheet sheet = testing::wavy_sheet(1000, 1);
  const RegistrationCloud target(sheet.positions, sheet.normals);
  for (std::size_t i = 0; i < 300; ++i) sheet.positions[i] += Vec3(0, 0, 5);
  const RegistrationCloud source(sheet.positions, sheet.normals);
  const RegistrationResult result =
      register_by_icp(source, target, motion(0.02, Vec3::UnitX(), Vec3::Zero()), {.max_distance = 0.2});
  EXPECT_LT(rotation_between(result.T_target_source, RigidTransform::Identity()), 1e-6);
  EXPECT_DOUBLE_EQ(result.inlier_ratio, 0.7);
}

TEST(Icp, StopsWhereTooFewPairsAreLeft) {
  const testing::Sheet sheet = testing::wavy_sheet(100, 1);
  const RegistrationCloud cloud(sheet.positions, sheet.normals);
  const RigidTransform far = motion(0.0, Vec3::UnitX(), Vec3(100, 0, 0));
  for (const IcpMetric metric : {IcpMetric::Point, IcpMetric::Plane, IcpMetric::Gicp}) {
    const RegistrationResult result = register_by_icp(cloud, cloud, far, with_metric(metric));
    EXPECT_EQ(result.stop, StopReason::TooFewPairs);
    EXPECT_FALSE(result.converged());
    EXPECT_EQ(result.iterations, 0U);
    EXPECT_TRUE(result.T_target_source.isApprox(far));
  }
}

TEST(Icp, PointsWithoutNormalAreLeftOutBySurfaceMetrics) {
  testing::Sheet sheet = testing::wavy_sheet(1000, 1);
  const RegistrationCloud target(sheet.positions, sheet.normals);
  for (std::size_t i = 0; i < 500; ++i) sheet.normals[i].setZero();
  const RegistrationCloud source(sheet.positions, sheet.normals);
  const RigidTransform start = motion(0.01, Vec3::UnitX(), Vec3::Zero());
  EXPECT_EQ(register_by_icp(source, target, start, with_metric(IcpMetric::Gicp)).inlier_ratio, 0.5);
  EXPECT_EQ(register_by_icp(source, target, start, with_metric(IcpMetric::Plane)).inlier_ratio, 1.0);
  EXPECT_EQ(register_by_icp(target, source, start, with_metric(IcpMetric::Plane)).inlier_ratio, 0.5);
}

TEST(Icp, TheSignOfNormalsDoesNotMatter) {
  testing::Sheet sheet = testing::wavy_sheet(1000, 1);
  const RegistrationCloud target(moved(sheet.positions, kPose), turned(sheet.normals, kPose));
  const RegistrationCloud source(sheet.positions, sheet.normals);
  for (std::size_t i = 0; i < sheet.normals.size(); i += 3) sheet.normals[i] *= -1.0;
  const RegistrationCloud flipped(sheet.positions, sheet.normals);
  const auto pose = [&](const RegistrationCloud& from) {
    return register_by_icp(from, target, RigidTransform::Identity(), with_metric(IcpMetric::Gicp)).T_target_source;
  };
  EXPECT_NEAR((pose(source).matrix() - pose(flipped).matrix()).norm(), 0.0, 1e-9);
}

TEST(Icp, RefusesWhatItCannotUse) {
  const testing::Sheet sheet = testing::wavy_sheet(100, 1);
  const RegistrationCloud cloud(sheet.positions, sheet.normals), bare(sheet.positions), tiny({Vec3::Zero()}), empty({});
  const RigidTransform I = RigidTransform::Identity();
  EXPECT_THROW((void)register_by_icp(cloud, bare, I), InvalidInput);
  EXPECT_NO_THROW((void)register_by_icp(bare, cloud, I));
  EXPECT_THROW((void)register_by_icp(bare, cloud, I, with_metric(IcpMetric::Gicp)), InvalidInput);
  EXPECT_THROW((void)register_by_icp(tiny, cloud, I), InvalidInput);
  EXPECT_THROW((void)register_by_icp(cloud, empty, I), InvalidInput);
  EXPECT_THROW((void)register_by_icp(cloud, cloud, I, {.max_iterations = 0}), InvalidInput);
  RigidTransform scaled = I;
  scaled.linear() *= 1.1;
  EXPECT_THROW((void)register_by_icp(cloud, cloud, scaled), InvalidInput);
  RigidTransform broken = I;
  broken.translation().x() = std::nan("");
  EXPECT_THROW((void)register_by_icp(cloud, cloud, broken), InvalidInput);
}

TEST(Icp, CanBeCancelledAndReportsProgress) {
  const testing::Sheet sheet = testing::wavy_sheet(500, 1);
  const RegistrationCloud source(sheet.positions, sheet.normals), target(moved(sheet.positions, kPose), sheet.normals);
  std::stop_source stop;
  double last = 0.0;
  RunContext context{.stop = stop.get_token(), .progress = [&](double fraction, std::string_view) {
                       EXPECT_GE(fraction, last);
                       last = fraction;
                     }};
  (void)register_by_icp(source, target, RigidTransform::Identity(), {}, context);
  EXPECT_EQ(last, 1.0);
  stop.request_stop();
  EXPECT_THROW((void)register_by_icp(source, target, RigidTransform::Identity(), {}, context), Cancelled);
}

}  // namespace
}  // namespace shapelight
