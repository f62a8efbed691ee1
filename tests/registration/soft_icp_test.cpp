#include "shapelight/registration/soft_icp.hpp"

#include <gtest/gtest.h>

#include <map>

#include "registration/soft_matches.hpp"
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

SoftIcpOptions with_candidates(int candidates) {
  SoftIcpOptions options;
  options.candidates = candidates;
  return options;
}

class SoftIcpCandidates : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(OneOrMore, SoftIcpCandidates, ::testing::Values(1, 6));

TEST_P(SoftIcpCandidates, FindsThePoseDespiteOutliers) {
  testing::Sheet sheet = testing::wavy_sheet(1000, 1);
  const RegistrationCloud target(moved(sheet.positions, kPose));
  for (std::size_t i = 0; i < 300; ++i) sheet.positions[i] += Vec3(0.5, 0.7 * random01(4, 0, i), 1.0);
  const RegistrationResult result = register_by_soft_icp(RegistrationCloud(sheet.positions), target,
                                                         RigidTransform::Identity(), with_candidates(GetParam()));
  EXPECT_TRUE(result.converged()) << stop_reason_name(result.stop);
  EXPECT_LT(rotation_between(result.T_target_source, kPose), 2e-3);
  EXPECT_LT((result.T_target_source * Vec3::Zero() - kPose * Vec3::Zero()).norm(), 2e-3);
  EXPECT_EQ(result.error.size(), result.iterations);
}

TEST_P(SoftIcpCandidates, FindsThePoseOfRealScans) {
  const testing::ScanPair scans = testing::dragon_pair(20);
  const RegistrationCloud source(scans.source), target(scans.target);
  const RigidTransform& truth = scans.T_target_source;
  for (std::uint64_t s = 0; s < 3; ++s) {
    const Vec3 axis(random01(1, 0, s) - 0.5, random01(1, 1, s) - 0.5, random01(1, 2, s) - 0.5);
    const RegistrationResult result =
        register_by_soft_icp(source, target, truth * motion(0.3, axis, Vec3(0, 0.003, 0)), with_candidates(GetParam()));
    EXPECT_LT(rotation_between(result.T_target_source, truth), 0.01);
  }
}

TEST_P(SoftIcpCandidates, IsTheSameInOtherUnits) {
  const testing::Sheet a = testing::wavy_sheet(300, 1), b = testing::wavy_sheet(350, 2);
  const auto pose_at = [&](double unit) {
    std::vector<Vec3> from = a.positions, to = moved(b.positions, kPose);
    for (Vec3& p : from) p *= unit;
    for (Vec3& p : to) p *= unit;
    RigidTransform T = register_by_soft_icp(RegistrationCloud(from), RegistrationCloud(to), RigidTransform::Identity(),
                                            with_candidates(GetParam()))
                           .T_target_source;
    T.translation() /= unit;
    return T;
  };
  EXPECT_NEAR((pose_at(1000.0).matrix() - pose_at(1.0).matrix()).norm(), 0.0, 1e-9);
}

TEST_P(SoftIcpCandidates, OpenCloudsGiveFinitePosesAndNoWildMotion) {
  const RigidTransform start = motion(0.05, Vec3(1, 1, 0), Vec3(0.02, 0.01, 0.03));
  for (const testing::OpenCloud& from : testing::open_clouds()) {
    for (const testing::OpenCloud& to : testing::open_clouds()) {
      for (const RigidTransform& T : {start, RigidTransform(RigidTransform::Identity())}) {
        const RegistrationResult result = register_by_soft_icp(
            RegistrationCloud(from.positions), RegistrationCloud(to.positions), T, with_candidates(GetParam()));
        EXPECT_TRUE(result.T_target_source.matrix().allFinite()) << from.name << " " << to.name;
        EXPECT_LT(result.T_target_source.translation().norm(), 10.0) << from.name << " " << to.name;
        EXPECT_TRUE(std::isfinite(result.rms)) << from.name << " " << to.name;
      }
    }
  }
}

TEST_P(SoftIcpCandidates, SameForAnyNumberOfThreads) {
  const testing::ScanPair scans = testing::dragon_pair(6);
  const RegistrationCloud source(scans.source), target(scans.target);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    SoftIcpOptions options = with_candidates(GetParam());
    options.rate = 0.4;
    options.max_iterations = 3;
    const RegistrationResult result = register_by_soft_icp(
        source, target, scans.T_target_source * motion(0.05, Vec3::UnitX(), Vec3::Zero()), options, context);
    return std::make_pair(Eigen::Matrix4d(result.T_target_source.matrix()), result.error);
  });
}

// Softassign over the full table of weights, pairs that neither search found being zero.
TEST_P(SoftIcpCandidates, WeightsAreThoseOfTheFullTable) {
  const std::vector<Vec3> a = test::random_points(40, 1), b = test::random_points(30, 2);
  const RegistrationCloud source(a), target(b);
  const auto k = static_cast<std::size_t>(GetParam());
  ClosestPoints forward(a, target, k), backward(b, source, k);
  forward.update(RigidTransform::Identity(), {}, 0.3);
  backward.update(RigidTransform::Identity(), {}, 0.3);
  SoftMatches soft(a.size(), b.size());
  soft.collect(forward, backward);
  soft.weigh(0.1, 1.5, 4);

  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(41, 31);  // slack in the last row and column
  for (std::size_t i = 0; i < 40; ++i) {
    for (std::size_t j = 0; j < 30; ++j) {
      const auto is_match = [](std::span<const Neighbor> matches, std::size_t index) {
        return std::any_of(matches.begin(), matches.end(), [&](const Neighbor& m) { return m.index == index; });
      };
      if (!is_match(forward.matches(i), j) && !is_match(backward.matches(j), i)) continue;
      W(i, j) = std::exp((1.5 * 1.5 * 0.01 - (a[i] - b[j]).squaredNorm()) / 0.02);
    }
  }
  W.col(30).setOnes();
  W.row(40).setOnes();
  for (int pass = 0; pass < 4; ++pass) {
    for (int i = 0; i < 40; ++i) W.row(i) /= W.row(i).sum();
    for (int j = 0; j < 30; ++j) W.col(j) /= W.col(j).sum();
  }
  std::map<std::pair<Index, Index>, double> seen;
  for (const SoftMatch& match : soft.matches()) {
    EXPECT_TRUE(seen.try_emplace({match.source, match.target}, match.weight).second) << "listed twice";
    EXPECT_NEAR(match.weight, W(match.source, match.target), 1e-12);
  }
  EXPECT_EQ(static_cast<Eigen::Index>(seen.size()), (W.topLeftCorner(40, 30).array() > 0.0).count());
  EXPECT_GT(seen.size(), 20U);
}

TEST(SoftIcp, StopsWhereTooFewPairsAreLeft) {
  SoftIcpOptions options;
  options.final_sigma = 0.01;
  const RegistrationCloud source(test::random_points(40, 1)), target(test::random_points(40, 2));
  const RegistrationResult result = register_by_soft_icp(source, target, RigidTransform::Identity(), options);
  EXPECT_EQ(result.stop, StopReason::TooFewPairs);
  EXPECT_TRUE(result.T_target_source.matrix().allFinite());
}

TEST(SoftIcp, RefusesFewPointsCanBeCancelledAndReportsProgress) {
  const RegistrationCloud cloud(test::random_points(50, 1)), few(test::random_points(9, 1));
  EXPECT_THROW((void)register_by_soft_icp(few, cloud, RigidTransform::Identity()), InvalidInput);
  std::stop_source stop;
  double last = 0.0;
  const RunContext context{.stop = stop.get_token(), .progress = [&](double fraction, std::string_view) {
                             EXPECT_GE(fraction, last);
                             last = fraction;
                           }};
  (void)register_by_soft_icp(cloud, cloud, kPose, {}, context);
  EXPECT_EQ(last, 1.0);
  stop.request_stop();
  EXPECT_THROW((void)register_by_soft_icp(cloud, cloud, kPose, {}, context), Cancelled);
}

}  // namespace
}  // namespace shapelight
