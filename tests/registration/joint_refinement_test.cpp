#include "shapelight/registration/joint_refinement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <numbers>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

// All scans at once: poses of partial views of a bumpy ball, known exactly.
namespace shapelight {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

constexpr double kDegree = std::numbers::pi / 180.0;

double height(const Vec3& d) {
  return 1.0 + 0.12 * std::sin(3.0 * d.x() + 1.0) + 0.1 * std::cos(4.0 * d.y()) + 0.1 * std::sin(5.0 * d.z() + d.x());
}

double level(const Vec3& p) { return p.norm() - height(p.normalized()); }

Vec3 normal_at(const Vec3& p) {
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = 1e-6 * Vec3::Unit(axis);
    gradient[axis] = level(p + step) - level(p - step);
  }
  return gradient.normalized();
}

RigidTransform motion(const Vec3& rotation, const Vec3& translation) {
  RigidTransform T = RigidTransform::Identity();
  if (rotation.norm() > 0.0) T.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
  T.translation() = translation;
  return T;
}

Vec3 random_vector(std::uint64_t stream, std::uint64_t id) {
  return {testing::gaussian(3, 10 * stream, id), testing::gaussian(3, 10 * stream + 1, id),
          testing::gaussian(3, 10 * stream + 2, id)};
}

// Views from around the equator, each of the half of the ball that faces it, from points of its own.
struct Ring {
  std::deque<RegistrationCloud> full, samples;  // addresses stay
  std::vector<ScanView> views;
  std::vector<RigidTransform> truth;  // the first scan is the world
  Pairs pairs;

  explicit Ring(std::size_t count, double noise = 0.0, double scale = 1.0) {
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
      truth.push_back(motion(0.5 * random_vector(1, i), scale * Vec3(std::cos(angle), std::sin(angle), 0.0)));
      const auto [position, normal] = view(i, Vec3(std::cos(angle), std::sin(angle), 0.0), noise, scale);
      full.emplace_back(position, normal);
      const std::size_t few = position.size() / 5;  // points are in random order
      samples.emplace_back(std::vector(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(few)),
                           std::vector(normal.begin(), normal.begin() + static_cast<std::ptrdiff_t>(few)));
      views.push_back({&full.back(), &samples.back()});
      pairs.emplace_back(i, (i + 1) % count);
    }
    const RigidTransform first = truth.front();
    for (RigidTransform& T : truth) T = first.inverse() * T;
  }

  std::pair<std::vector<Vec3>, std::vector<Vec3>> view(std::size_t i, const Vec3& look, double noise, double scale) {
    std::pair<std::vector<Vec3>, std::vector<Vec3>> points;
    const RigidTransform T_scan_object = truth[i].inverse();
    for (std::size_t k = 0; k < 8000; ++k) {
      const Vec3 direction = random_vector(2, 10000 * i + k).normalized();
      if (direction.dot(look) < 0.0) continue;
      const Vec3 p = height(direction) * direction;
      const Vec3 n = normal_at(p);
      points.first.push_back(T_scan_object * Vec3(scale * (p + noise * testing::gaussian(4, i, k) * n)));
      points.second.push_back(T_scan_object.linear() * n);
    }
    return points;
  }

  [[nodiscard]] std::vector<RigidTransform> disturbed(double degrees, double shift) const {
    std::vector<RigidTransform> poses = truth;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      poses[i] = poses[i] *
                 motion(degrees * kDegree * random_vector(5, i).normalized(), shift * random_vector(6, i).normalized());
    }
    return poses;
  }

  [[nodiscard]] double largest_angle(const std::vector<RigidTransform>& poses) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      largest = std::max(largest, Eigen::AngleAxisd(truth[i].linear().transpose() * poses[i].linear()).angle());
    }
    return largest / kDegree;
  }
};

TEST(JointRefinement, FindsTheExactPosesOfARing) {
  const Ring ring(6);
  const auto start = ring.disturbed(0.5, 0.01);
  const JointRefinementResult result = refine_jointly(ring.views, ring.pairs, start);
  EXPECT_TRUE(result.converged);
  EXPECT_GT(ring.largest_angle(start), 0.45);
  EXPECT_LT(ring.largest_angle(result.T_world_scan), 0.06);
  EXPECT_TRUE(result.T_world_scan[0].matrix() == start[0].matrix()) << "the first scan is the world";
}

// Pairs by themselves add up their errors around the ring; all at once cannot.
TEST(JointRefinement, NoiseAveragesOut) {
  const Ring ring(6, 0.002);
  const JointRefinementResult result = refine_jointly(ring.views, ring.pairs, ring.disturbed(0.5, 0.01));
  EXPECT_TRUE(result.converged);
  EXPECT_LT(ring.largest_angle(result.T_world_scan), 0.2);
}

TEST(JointRefinement, UnitsDoNotMatter) {
  const Ring ring(4), large(4, 0.0, 1000.0);
  const auto small = refine_jointly(ring.views, ring.pairs, ring.disturbed(0.5, 0.01));
  const auto scaled = refine_jointly(large.views, large.pairs, large.disturbed(0.5, 10.0));
  EXPECT_EQ(small.iterations, scaled.iterations);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(small.T_world_scan[i].linear().isApprox(scaled.T_world_scan[i].linear(), 1e-6));
  }
}

TEST(JointRefinement, PairsThatSeeNothingInCommonStay) {
  const Ring ring(4);
  auto apart = ring.disturbed(0.5, 0.01);
  apart[2].translation() += Vec3(100, 0, 0);
  const Pairs pairs = {{0, 1}, {2, 3}};
  apart[3].translation() -= Vec3(100, 0, 0);
  const JointRefinementResult result = refine_jointly(ring.views, pairs, apart);
  EXPECT_TRUE(result.T_world_scan[2].matrix() == apart[2].matrix()) << "the first of its set";
  EXPECT_TRUE(result.T_world_scan[3].matrix() == apart[3].matrix()) << "nothing pulls at it";
  EXPECT_FALSE(result.T_world_scan[1].matrix() == apart[1].matrix());
  const JointRefinementResult nothing = refine_jointly(ring.views, {}, apart);
  EXPECT_TRUE(nothing.converged);
  EXPECT_TRUE(nothing.T_world_scan[1].matrix() == apart[1].matrix());
}

TEST(JointRefinement, MeasuresOverlapAndDistance) {
  const Ring ring(4, 0.002);
  const RigidTransform T = ring.truth[0].inverse() * ring.truth[1];
  const PairFit right = measure_fit(ring.views[0], ring.views[1], T);
  EXPECT_NEAR(right.overlap, 0.5, 0.08) << "a quarter turn apart";
  EXPECT_NEAR(right.rms, std::sqrt(2.0) * 0.002, 0.0012);
  EXPECT_NEAR(measure_fit(ring.views[1], ring.views[0], T.inverse()).overlap, right.overlap, 1e-12);
  EXPECT_LT(measure_fit(ring.views[0], ring.views[2], ring.truth[0].inverse() * ring.truth[2]).overlap, 0.08);
  EXPECT_EQ(measure_fit(ring.views[0], ring.views[1], motion(Vec3::Zero(), {50, 0, 0})).matches, 0u);
}

// Two sheets back to back are not the same surface, where it is known which side was seen.
TEST(JointRefinement, SidesAreToldApartByTheViewpoint) {
  const auto sheet = [](double side) {
    std::vector<Vec3> position;
    for (int x = 0; x < 20; ++x) {
      for (int y = 0; y < 20; ++y) position.emplace_back(0.1 * x, 0.1 * y, 0.0);
    }
    return RegistrationCloud(position, std::vector<Vec3>(position.size(), Vec3(0, 0, side)));
  };
  RegistrationCloud front = sheet(1.0), back = sheet(-1.0);
  const ScanView a{&front, &front}, b{&back, &back};
  EXPECT_EQ(measure_fit(a, b, RigidTransform::Identity()).overlap, 1.0) << "signs mean nothing";
  front.viewpoint = Vec3(0, 0, 5);
  back.viewpoint = Vec3(0, 0, -5);
  EXPECT_EQ(measure_fit(a, b, RigidTransform::Identity()).overlap, 0.0);
}

TEST(JointRefinement, SameForAnyNumberOfThreads) {
  const Ring ring(4, 0.005);
  const auto start = ring.disturbed(0.5, 0.01);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    std::vector<double> numbers;
    for (const RigidTransform& T : refine_jointly(ring.views, ring.pairs, start, {}, context).T_world_scan) {
      numbers.insert(numbers.end(), T.data(), T.data() + 16);
    }
    return numbers;
  });
}

TEST(JointRefinement, RefusesWhatMakesNoSense) {
  const Ring ring(3);
  const Pairs beyond = {{0, 3}}, itself = {{1, 1}};
  EXPECT_THROW((void)refine_jointly(ring.views, beyond, ring.truth), InvalidInput);
  EXPECT_THROW((void)refine_jointly(ring.views, itself, ring.truth), InvalidInput);
  const std::vector<RigidTransform> few(2, RigidTransform::Identity());
  EXPECT_THROW((void)refine_jointly(ring.views, ring.pairs, few), InvalidInput);
  const RegistrationCloud bare(ring.full[0].position);
  std::vector<ScanView> views = ring.views;
  views[1].full = &bare;
  EXPECT_THROW((void)refine_jointly(views, ring.pairs, ring.truth), InvalidInput);
  EXPECT_THROW((void)measure_fit(views[0], views[1], ring.truth[0]), InvalidInput);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW((void)refine_jointly(ring.views, ring.pairs, ring.truth, {}, {0, stop.get_token(), {}}), Cancelled);
}

}  // namespace
}  // namespace shapelight
