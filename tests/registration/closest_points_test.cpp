#include "registration/closest_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/determinism.hpp"
#include "support/random_points.hpp"
#include "support/registration_clouds.hpp"

namespace shapelight {
namespace {

using test::random_points;
using testing::motion;

std::vector<Neighbor> brute_force(std::span<const Vec3> points, const Vec3& query, std::size_t k, double max_distance) {
  std::vector<Neighbor> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double dx = points[i].x() - query.x(), dy = points[i].y() - query.y(), dz = points[i].z() - query.z();
    const double d = dx * dx + dy * dy + dz * dz;
    if (d <= max_distance * max_distance) all.push_back({d, static_cast<Index>(i)});
  }
  std::sort(all.begin(), all.end());
  all.resize(k);
  return all;
}

// Half of the points on a lattice, so that ties and duplicates are common.
std::vector<Vec3> points_with_ties(std::size_t count, std::uint64_t seed) {
  std::vector<Vec3> points = random_points(count, seed);
  for (std::size_t i = 0; i < count; i += 2) points[i] = (points[i] * 4.0).array().floor().matrix() / 4.0;
  return points;
}

// Steps of all sizes: none, tiny, and wild ones.
RigidTransform step_number(int i, const RigidTransform& T) {
  if (i % 5 == 0) return T;
  const double size = i % 7 == 0 ? 0.5 : 0.02 / (1 + i);
  const auto id = static_cast<std::uint64_t>(i);
  return motion(size, Vec3(random01(1, 0, id), 0.3, random01(1, 1, id) - 0.5), size * Vec3(0.3, -0.2, 0.5)) * T;
}

TEST(ClosestPoints, AreThoseOfFreshSearchesHoweverThePointsMove) {
  const std::vector<Vec3> points = points_with_ties(150, 1);
  const RegistrationCloud target(points_with_ties(300, 2));
  for (const std::size_t k : {std::size_t{1}, std::size_t{4}}) {
    for (const double max_distance : {HUGE_VAL, 0.12}) {
      ClosestPoints closest(points, target, k);
      RigidTransform T = RigidTransform::Identity();
      for (int i = 0; i < 40; ++i) {
        T = step_number(i, T);
        closest.update(T, {}, max_distance);
        for (std::size_t p = 0; p < points.size(); ++p) {
          const std::vector<Neighbor> expected = brute_force(target.position, T * points[p], k, max_distance);
          for (std::size_t j = 0; j < k; ++j) {
            ASSERT_EQ(closest.matches(p)[j].index, expected[j].index) << "step " << i << " point " << p;
            if (expected[j].index != kNoIndex) {
              ASSERT_EQ(closest.matches(p)[j].distance_sq, expected[j].distance_sq);
            }
          }
        }
      }
    }
  }
}

TEST(ClosestPoints, SmallMotionsNeedFewSearches) {
  const std::vector<Vec3> points = random_points(1000, 1);
  const RegistrationCloud target(random_points(1000, 2));
  ClosestPoints closest(points, target);
  for (int i = 0; i < 20; ++i) closest.update(motion(0.0, Vec3::UnitX(), Vec3(1e-4 * i, 0, 0)), {});
  EXPECT_GE(closest.searches(), 1000U);
  EXPECT_LE(closest.searches(), 1100U);
}

TEST(ClosestPoints, TheGateMayMove) {
  const std::vector<Vec3> points = random_points(100, 1);
  const RegistrationCloud target(random_points(100, 2));
  ClosestPoints closest(points, target);
  for (const double gate : {0.3, 0.05, 0.2, 0.0, HUGE_VAL}) {
    closest.update(RigidTransform::Identity(), {}, gate);
    for (std::size_t p = 0; p < points.size(); ++p) {
      EXPECT_EQ(closest.match(p).index, brute_force(target.position, points[p], 1, gate)[0].index);
    }
  }
}

TEST(ClosestPoints, SaysWhetherAnyMatchChanged) {
  const std::vector<Vec3> points = {Vec3(0, 0, 0), Vec3(1, 0, 0)};
  const RegistrationCloud target({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)});
  ClosestPoints closest(points, target);
  EXPECT_TRUE(closest.update(RigidTransform::Identity(), {}));
  EXPECT_FALSE(closest.update(motion(0.0, Vec3::UnitX(), Vec3(0.4, 0, 0)), {}));
  EXPECT_TRUE(closest.update(motion(0.0, Vec3::UnitX(), Vec3(0.6, 0, 0)), {}));
}

TEST(ClosestPoints, FewerTargetsThanAskedFor) {
  const std::vector<Vec3> points = {Vec3(0, 0, 0)};
  const RegistrationCloud target({Vec3(3, 0, 0), Vec3(1, 0, 0)});
  ClosestPoints closest(points, target, 3);
  closest.update(RigidTransform::Identity(), {});
  EXPECT_EQ(closest.matches(0)[0].index, 1U);
  EXPECT_EQ(closest.matches(0)[1].index, 0U);
  EXPECT_EQ(closest.matches(0)[2].index, kNoIndex);
}

TEST(ClosestPoints, SameForAnyNumberOfThreads) {
  const std::vector<Vec3> points = random_points(10000, 1);
  const RegistrationCloud target(random_points(9000, 2));
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    ClosestPoints closest(points, target);
    std::vector<Index> matches;
    for (int i = 0; i < 4; ++i) {
      closest.update(motion(0.01 * i, Vec3::UnitZ(), Vec3::Zero()), context);
      for (std::size_t p = 0; p < points.size(); ++p) matches.push_back(closest.match(p).index);
    }
    matches.push_back(static_cast<Index>(closest.searches()));
    return matches;
  });
}

}  // namespace
}  // namespace shapelight
