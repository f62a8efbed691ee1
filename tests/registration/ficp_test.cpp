#include "shapelight/registration/ficp.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "registration/rigid_fit.hpp"
#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/random_points.hpp"
#include "support/registration_clouds.hpp"

namespace shapelight {
namespace {

using testing::motion;
using testing::moved;
using testing::rotation_between;

const RigidTransform kPose = motion(0.15, Vec3(1, -2, 1), Vec3(0.05, 0.03, -0.04));

FicpOptions pure(double lambda = 0.95) {
  FicpOptions options;
  options.lambda = options.start_lambda = lambda;
  return options;
}

void expect_never_rising(std::span<const double> error) {
  for (std::size_t i = 1; i < error.size(); ++i) {
    EXPECT_LE(error[i], error[i - 1] * (1.0 + 1e-12) + 1e-15) << "iteration " << i;
  }
}

TEST(Ficp, FrmsdNeverRises) {
  const testing::ScanPair scans = testing::dragon_pair(30);
  const RegistrationCloud source(scans.source), target(scans.target);
  const RegistrationCloud random_a(test::random_points(700, 1)), random_b(test::random_points(600, 2));
  for (const double lambda : {0.5, 0.95, 1.3, 3.0}) {
    for (std::uint64_t s = 0; s < 3; ++s) {
      const Vec3 axis(random01(1, 0, s) - 0.5, random01(1, 1, s) - 0.5, random01(1, 2, s) - 0.5);
      const RigidTransform start = scans.T_target_source * motion(0.3, axis, Vec3(0.005, 0.0, -0.005));
      const RegistrationResult fit = register_by_ficp(source, target, start, pure(lambda));
      EXPECT_GT(fit.error.size(), 5U);
      expect_never_rising(fit.error);
      expect_never_rising(
          register_by_ficp(random_a, random_b, motion(0.5, axis, Vec3(0.1, 0.2, 0)), pure(lambda)).error);
    }
  }
}

TEST(Ficp, FindsThePoseOfRealScans) {
  const testing::ScanPair scans = testing::dragon_pair(10);
  const RegistrationCloud source(scans.source), target(scans.target);
  const RigidTransform& truth = scans.T_target_source;
  for (std::uint64_t s = 0; s < 4; ++s) {
    const Vec3 axis(random01(1, 0, s) - 0.5, random01(1, 1, s) - 0.5, random01(1, 2, s) - 0.5);
    const RegistrationResult result = register_by_ficp(source, target, truth * motion(0.3, axis, Vec3(0, 0.003, 0)));
    EXPECT_TRUE(result.converged());
    EXPECT_LT(rotation_between(result.T_target_source, truth), 0.01);
    EXPECT_GT(result.inlier_ratio, 0.4);
  }
}

// The method as its paper states it, with nothing clever in it.
RigidTransform one_naive_step(const std::vector<Vec3>& source, const std::vector<Vec3>& target, double lambda,
                              double* frmsd, double* fraction) {
  std::vector<std::pair<double, std::pair<std::size_t, std::size_t>>> pairs;
  for (std::size_t i = 0; i < source.size(); ++i) {
    std::size_t best = 0;
    for (std::size_t j = 1; j < target.size(); ++j) {
      if ((source[i] - target[j]).squaredNorm() < (source[i] - target[best]).squaredNorm()) best = j;
    }
    pairs.push_back({(source[i] - target[best]).squaredNorm(), {i, best}});
  }
  std::sort(pairs.begin(), pairs.end());
  double sum = 0.0;
  *frmsd = HUGE_VAL;
  std::size_t count = 0;
  for (std::size_t k = 1; k <= pairs.size(); ++k) {
    sum += pairs[k - 1].first;
    const double f = static_cast<double>(k) / static_cast<double>(pairs.size());
    const double value = std::pow(f, -lambda) * std::sqrt(sum / static_cast<double>(k));
    if (k < 10 || f < 0.05 || value >= *frmsd) continue;
    *frmsd = value;
    *fraction = f;
    count = k;
  }
  RigidFit fit(Vec3::Zero());
  for (std::size_t k = 0; k < count; ++k) fit.add(source[pairs[k].second.first], target[pairs[k].second.second]);
  return fit.solve();
}

TEST(Ficp, EachIterationIsThatOfThePaper) {
  const testing::Sheet a = testing::wavy_sheet(300, 1), b = testing::wavy_sheet(350, 2);
  for (const double lambda : {0.95, 3.0}) {
    RigidTransform T = kPose;
    for (int i = 0; i < 6; ++i) {
      FicpOptions options = pure(lambda);
      options.max_iterations = 1;
      const RegistrationResult result =
          register_by_ficp(RegistrationCloud(a.positions), RegistrationCloud(b.positions), T, options);
      double frmsd = 0.0, fraction = 0.0;
      T = one_naive_step(moved(a.positions, T), b.positions, lambda, &frmsd, &fraction) * T;
      EXPECT_NEAR(result.error.front(), frmsd, 1e-12);
      EXPECT_NEAR(result.inlier_ratio, fraction, 1e-12);
      EXPECT_NEAR((result.T_target_source.matrix() - T.matrix()).norm(), 0.0, 1e-10);
    }
  }
}

TEST(Ficp, TheFixedPointIsExact) {
  const testing::Sheet a = testing::wavy_sheet(400, 1), b = testing::wavy_sheet(400, 2);
  const RegistrationCloud source(a.positions), target(moved(b.positions, kPose));
  FicpOptions options = pure();
  options.rotation_tolerance = options.translation_tolerance = 0.0;
  const RegistrationResult result = register_by_ficp(source, target, RigidTransform::Identity(), options);
  ASSERT_EQ(result.stop, StopReason::FixedPoint);
  const RegistrationResult again = register_by_ficp(source, target, result.T_target_source, options);
  EXPECT_EQ(again.stop, StopReason::FixedPoint);
  EXPECT_LE(again.iterations, 2U);
  EXPECT_NEAR((again.T_target_source.matrix() - result.T_target_source.matrix()).norm(), 0.0, 1e-12);
}

TEST(Ficp, LeavesOutliersOut) {
  testing::Sheet sheet = testing::wavy_sheet(1000, 1);
  const RegistrationCloud target(moved(sheet.positions, kPose));
  for (std::size_t i = 0; i < 400; ++i) sheet.positions[i] += Vec3(0.5, 0.7 * random01(4, 0, i), 1.0);
  const RegistrationResult result =
      register_by_ficp(RegistrationCloud(sheet.positions), target, RigidTransform::Identity());
  EXPECT_LT(rotation_between(result.T_target_source, kPose), 1e-6);
  EXPECT_NEAR(result.inlier_ratio, 0.6, 0.01);
  EXPECT_LT(result.rms, 1e-6);
}

TEST(Ficp, ACopyInPlaceKeepsAllPairs) {
  const std::vector<Vec3> points = test::random_points(500, 1);
  const RegistrationResult result =
      register_by_ficp(RegistrationCloud(points), RegistrationCloud(points), RigidTransform::Identity());
  EXPECT_TRUE(result.converged());
  EXPECT_EQ(result.inlier_ratio, 1.0);
  EXPECT_TRUE(result.T_target_source.matrix().isIdentity(1e-12));
}

TEST(Ficp, TrustsNoFewerPairsThanAllowed) {
  const std::vector<Vec3> points = test::random_points(300, 1);
  const RegistrationCloud source(points), target(test::random_points(300, 2));
  FicpOptions options = pure(0.01);
  options.min_fraction = 0.25;
  EXPECT_GE(register_by_ficp(source, target, RigidTransform::Identity(), options).inlier_ratio, 0.25);
  options = pure(50.0);
  options.max_fraction = 0.5;
  EXPECT_LE(register_by_ficp(source, target, RigidTransform::Identity(), options).inlier_ratio, 0.5);
  options.min_fraction = 0.6;
  EXPECT_THROW((void)register_by_ficp(source, target, RigidTransform::Identity(), options), InvalidInput);
}

TEST(Ficp, IsTheSameInOtherUnits) {
  const testing::Sheet a = testing::wavy_sheet(500, 1), b = testing::wavy_sheet(600, 2);
  const auto pose_at = [&](double unit) {
    std::vector<Vec3> from = a.positions, to = moved(b.positions, kPose);
    for (Vec3& p : from) p *= unit;
    for (Vec3& p : to) p *= unit;
    RigidTransform T =
        register_by_ficp(RegistrationCloud(from), RegistrationCloud(to), RigidTransform::Identity()).T_target_source;
    T.translation() /= unit;
    return T;
  };
  EXPECT_NEAR((pose_at(1000.0).matrix() - pose_at(1.0).matrix()).norm(), 0.0, 1e-9);
}

TEST(Ficp, OpenCloudsGiveFinitePosesAndNoWildMotion) {
  const RigidTransform start = motion(0.05, Vec3(1, 1, 0), Vec3(0.02, 0.01, 0.03));
  for (const testing::OpenCloud& from : testing::open_clouds()) {
    for (const testing::OpenCloud& to : testing::open_clouds()) {
      const RegistrationResult result =
          register_by_ficp(RegistrationCloud(from.positions), RegistrationCloud(to.positions), start);
      EXPECT_TRUE(result.T_target_source.matrix().allFinite()) << from.name << " " << to.name;
      EXPECT_LT(result.T_target_source.translation().norm(), 10.0) << from.name << " " << to.name;
      EXPECT_TRUE(std::isfinite(result.rms) && std::isfinite(result.error.back()));
    }
  }
}

TEST(Ficp, SameForAnyNumberOfThreads) {
  const testing::ScanPair scans = testing::dragon_pair(4);
  const RegistrationCloud source(scans.source), target(scans.target);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    FicpOptions options;
    options.max_iterations = 5;
    const RegistrationResult result = register_by_ficp(
        source, target, scans.T_target_source * motion(0.1, Vec3::UnitX(), Vec3::Zero()), options, context);
    return std::make_pair(Eigen::Matrix4d(result.T_target_source.matrix()), result.error);
  });
}

TEST(Ficp, RefusesFewPointsAndCanBeCancelled) {
  const RegistrationCloud cloud(test::random_points(50, 1)), few(test::random_points(9, 1));
  EXPECT_THROW((void)register_by_ficp(few, cloud, RigidTransform::Identity()), InvalidInput);
  EXPECT_THROW((void)register_by_ficp(cloud, few, RigidTransform::Identity()), InvalidInput);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW((void)register_by_ficp(cloud, cloud, RigidTransform::Identity(), {}, {.stop = stop.get_token()}),
               Cancelled);
}

}  // namespace
}  // namespace shapelight
