#include "shapelight/synthetic/scan_pair.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "shapelight/core/error.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

struct Object {
  TriangleTree tree;
  BoundingSphere sphere;
  explicit Object(const Geometry& geometry)
      : tree({geometry.positions, geometry.triangles}), sphere(bounding_sphere(geometry.positions)) {}
};

ScanPairOptions options_for(double overlap) {
  ScanPairOptions options;
  options.overlap = overlap;
  options.scan.width = options.scan.height = 80;
  return options;
}

// Points one apart on a line, from `begin` on.
Geometry line(int begin, int count) {
  Geometry geometry;
  for (int i = 0; i < count; ++i) geometry.positions.emplace_back(begin + i, 0, 0);
  return geometry;
}

TEST(ScanOverlap, CountsPointsWithinTwoSpacings) {
  const RigidTransform same = RigidTransform::Identity();
  EXPECT_EQ(scan_overlap(line(0, 10), line(0, 10), same), 1.0);
  EXPECT_EQ(scan_overlap(line(0, 10), line(7, 10), same), 0.5) << "5 and 6 are two spacings from 7";
  EXPECT_EQ(scan_overlap(line(0, 10), line(50, 10), same), 0.0);
  RigidTransform shift = RigidTransform::Identity();
  shift.translation() = Vec3(50, 0, 0);
  EXPECT_EQ(scan_overlap(line(0, 10), line(50, 10), shift), 1.0);
}

TEST(ScanOverlap, EmptyAndNonFinite) {
  const RigidTransform same = RigidTransform::Identity();
  EXPECT_EQ(scan_overlap({}, line(0, 3), same), 0.0);
  EXPECT_EQ(scan_overlap(line(0, 3), {}, same), 0.0);
  EXPECT_EQ(scan_overlap(line(0, 1), line(0, 1), same), 1.0);
  Geometry holes = line(0, 4);
  holes.positions[1].y() = std::nan("");
  EXPECT_EQ(scan_overlap(holes, line(0, 10), same), 1.0);
  EXPECT_EQ(scan_overlap(line(0, 4), holes, same), 1.0);
}

TEST(ScanPair, HasTheOverlapAskedForAndTheExactTruth) {
  const Object bunny(testing::read_data("meshes/bunny.ply"));
  double last = 0.0;
  for (const double overlap : {0.9, 0.7, 0.5}) {
    ScanPairOptions options = options_for(overlap);
    options.scan.random_pose = true;
    const ScanPair pair = scan_pair(bunny.tree, bunny.sphere, options);
    EXPECT_NEAR(pair.overlap, overlap, 0.01);
    EXPECT_NEAR(scan_overlap(pair.source.geometry, pair.target.geometry, pair.T_target_source), pair.overlap, 1e-3);
    EXPECT_GT(pair.azimuth_between, last) << "less overlap, farther apart";
    last = pair.azimuth_between;
    for (const Vec3& p : pair.source.geometry.positions) {
      const Vec3 on_mesh = pair.target.T_mesh_scan * (pair.T_target_source * p);
      ASSERT_LT(std::sqrt(bunny.tree.closest(on_mesh).distance_sq), 1e-12);
    }
    EXPECT_GT((pair.T_target_source.linear() - Eigen::Matrix3d::Identity()).norm(), 0.1) << "not the identity";
  }
}

TEST(ScanPair, TheTwoScansErrIndependently) {
  const testing::Shape shape = testing::sphere(5, 1.0);  // looks the same from everywhere
  Geometry geometry;
  geometry.positions = shape.positions;
  geometry.triangles = shape.triangles;
  const Object ball(geometry);
  ScanPairOptions options = options_for(0.8);
  options.scan.noise = 0.001;
  options.scan.dropout = 0.1;
  const ScanPair pair = scan_pair(ball.tree, ball.sphere, options);
  EXPECT_NEAR(pair.overlap, 0.8, 0.01) << "of the exact scans";
  double seen = 0.0, both = 0.0, near = 0.0;
  for (std::size_t i = 0; i < pair.source.geometry.grid->pixel.size(); ++i) {
    const Index source = pair.source.geometry.grid->pixel[i], target = pair.target.geometry.grid->pixel[i];
    if (source == kNoIndex) continue;
    ++seen;
    if (target == kNoIndex) continue;
    ++both;
    const double apart = pair.source.geometry.positions[source].norm() - pair.target.geometry.positions[target].norm();
    near += std::abs(apart) < 0.2 * options.scan.noise;
  }
  EXPECT_NEAR(both / seen, 0.9, 0.02) << "other pixels drop out";
  EXPECT_LT(near / both, 0.3) << "other noise";
}

TEST(ScanPair, SaysWhenThereIsNoSuchPair) {
  // A plate seen from above: every view shows all of it.
  testing::Shape plate = testing::plane(12, 0.1);
  Geometry geometry;
  for (const Vec3& p : plate.positions) geometry.positions.emplace_back(p.x(), 0.0, p.y());
  geometry.triangles = plate.triangles;
  const Object object(geometry);
  ScanPairOptions options = options_for(0.3);
  options.elevation = 1.5;
  EXPECT_THROW((void)scan_pair(object.tree, object.sphere, options), TargetUnreachable);
  options.overlap = 1.5;
  EXPECT_THROW((void)scan_pair(object.tree, object.sphere, options), InvalidInput);
}

TEST(ScanPair, DoesNotDependOnThreads) {
  const Object fandisk(testing::read_data("meshes/fandisk.off"));
  ScanPairOptions options = options_for(0.7);
  options.scan.noise = 0.001;
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const ScanPair pair = scan_pair(fandisk.tree, fandisk.sphere, options, context);
    return std::tuple(pair.source.geometry.positions, pair.target.geometry.positions, pair.overlap);
  });
}

}  // namespace
}  // namespace shapelight
