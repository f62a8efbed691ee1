#include "registration/rigid_fit.hpp"

#include <gtest/gtest.h>

#include "registration/normal_equations.hpp"
#include "support/random_points.hpp"
#include "support/registration_clouds.hpp"

namespace shapelight {
namespace {

using testing::motion;

RigidTransform fit(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  RigidFit sums(to.front());
  for (std::size_t i = 0; i < from.size(); ++i) sums.add(from[i], to[i], 0.5 + random01(9, 0, i));
  return sums.solve();
}

TEST(RigidFit, FindsTheMotionOfExactPairs) {
  const std::vector<Vec3> points = test::random_points(50, 1);
  for (const double angle : {0.0, 1e-7, 0.3, 3.1}) {
    const RigidTransform T = motion(angle, Vec3(1, -2, 0.5), Vec3(3, 1, -2));
    const RigidTransform found = fit(points, testing::moved(points, T));
    EXPECT_NEAR((found.matrix() - T.matrix()).norm(), 0.0, 2e-8) << angle;  // the pull towards stillness
  }
}

TEST(RigidFit, NeverMirrors) {
  std::vector<Vec3> points = test::random_points(30, 1), mirrored = points;
  for (Vec3& p : mirrored) p.x() = -p.x();
  EXPECT_NEAR(fit(points, mirrored).linear().determinant(), 1.0, 1e-12);
}

TEST(RigidFit, APlaneDeterminesTheMotion) {
  std::vector<Vec3> points = test::random_points(30, 1);
  for (Vec3& p : points) p.z() = 0.0;
  const RigidTransform T = motion(1.0, Vec3(1, 2, 3), Vec3(1, 0, 0));
  EXPECT_NEAR((fit(points, testing::moved(points, T)).matrix() - T.matrix()).norm(), 0.0, 1e-7);
}

TEST(RigidFit, DoesNotTurnALineAboutItself) {
  const std::vector<Vec3> line = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2.5, 0, 0)};
  const std::vector<Vec3> turned = {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 2.5, 0)};
  const RigidTransform T = fit(line, turned);
  EXPECT_NEAR((T * Vec3::UnitX() - Vec3::UnitY()).norm(), 0.0, 1e-7);
  EXPECT_NEAR((T * Vec3::UnitZ() - Vec3::UnitZ()).norm(), 0.0, 1e-6);  // the shortest way there
}

TEST(RigidFit, TurnsAnyLineTheShortestWay) {
  for (std::uint64_t s = 0; s < 20; ++s) {
    const Vec3 a = Vec3(random01(1, 0, s), random01(1, 1, s), random01(1, 2, s)).normalized();
    const Vec3 b = Vec3(random01(2, 0, s), random01(2, 1, s), random01(2, 2, s)).normalized();
    std::vector<Vec3> from, to;
    for (std::uint64_t i = 0; i < 10; ++i) {
      from.push_back(random01(3, s, i) * a + b);
      to.push_back(random01(3, s, i) * b);
    }
    const double angle = testing::rotation_between(fit(from, to), RigidTransform::Identity());
    EXPECT_NEAR(angle, std::acos(a.dot(b)), 1e-5);
  }
}

TEST(RigidFit, OnePlaceIsShiftedOnly) {
  const RigidTransform T = fit(std::vector<Vec3>(5, Vec3(1, 2, 3)), std::vector<Vec3>(5, Vec3(2, 2, 2)));
  EXPECT_TRUE(T.linear().isIdentity(1e-12));
  EXPECT_TRUE(T.translation().isApprox(Vec3(1, 0, -1)));
  EXPECT_TRUE(RigidFit(Vec3::Zero()).solve().matrix().isIdentity());
}

TEST(RigidFit, PartsJoinToTheWhole) {
  const std::vector<Vec3> points = test::random_points(20, 1);
  const std::vector<Vec3> to = test::random_points(20, 2);
  RigidFit whole(Vec3::Zero()), front(Vec3::Zero()), back(Vec3::Zero());
  for (std::size_t i = 0; i < 20; ++i) {
    whole.add(points[i], to[i], 2.0);
    (i < 7 ? front : back).add(points[i], to[i], 2.0);
  }
  front += back;
  EXPECT_TRUE(front.solve().isApprox(whole.solve(), 1e-12));
}

TEST(NormalEquations, PlanesAndTheirMatricesAgree) {
  NormalEquations planes(Vec3(0.1, 0.2, 0.3), 2.0), matrices = planes;
  const std::vector<Vec3> x = test::random_points(40, 1), q = test::random_points(40, 2);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 n = Vec3(random01(3, 0, i) - 0.5, random01(3, 1, i) - 0.5, random01(3, 2, i)).normalized();
    planes.add_plane(x[i], x[i] - q[i], n);
    matrices.add_matrix(x[i], x[i] - q[i], n * n.transpose());
  }
  EXPECT_NEAR(planes.cost(), matrices.cost(), 1e-12);
  EXPECT_TRUE(planes.solve().isApprox(matrices.solve(), 1e-9));
}

TEST(NormalEquations, OneStepSolvesASmallMotion) {
  const RigidTransform T = motion(1e-5, Vec3(1, 2, -1), Vec3(1e-5, 0, -2e-5));
  const testing::Sheet sheet = testing::wavy_sheet(200, 1);
  NormalEquations equations(Vec3(0.5, 0, 0), 2.0);
  for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
    equations.add_plane(sheet.positions[i], sheet.positions[i] - T * sheet.positions[i], sheet.normals[i]);
  }
  const RigidTransform found = equations.to_motion(equations.solve());
  EXPECT_NEAR((found.matrix() - T.matrix()).norm(), 0.0, 1e-9);
}

TEST(NormalEquations, APlaneIsNotMovedWithinItself) {
  NormalEquations equations(Vec3::Zero(), 1.0);
  for (const Vec3& p : test::random_points(50, 1)) {
    const Vec3 x(p.x(), p.y(), 0.25);
    equations.add_plane(x, Vec3(0.3, -0.1, 0.25), Vec3::UnitZ());
  }
  const RigidTransform found = equations.to_motion(equations.solve());
  EXPECT_NEAR((found.translation() - Vec3(0, 0, -0.25)).norm(), 0.0, 1e-9);
  EXPECT_TRUE(found.linear().isIdentity(1e-9));
  EXPECT_TRUE(NormalEquations(Vec3::Zero(), 1.0).solve().isZero());
}

}  // namespace
}  // namespace shapelight
