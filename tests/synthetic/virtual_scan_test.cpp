#include "shapelight/synthetic/virtual_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TriangleTree tree_of(const testing::Shape& shape) { return TriangleTree({shape.positions, shape.triangles}); }

VirtualScanOptions small(int width = 40, int height = 40) {
  VirtualScanOptions options;
  options.width = width;
  options.height = height;
  return options;
}

// A wall of 2 x 2 at z = 0, which the camera sees whole, straight ahead, from 5 away.
TriangleTree wall() { return TriangleTree({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}); }
VirtualCamera at_the_wall(double angle = 0.0) {
  VirtualCamera camera;
  camera.T_mesh_camera = Eigen::AngleAxisd(angle, Vec3::UnitY()) * Eigen::Translation3d(0, 0, 5) *
                         Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX());
  camera.field_of_view = 2.0 * std::atan(0.19);
  return camera;
}

TEST(VirtualScan, AWallIsAGridOfKnownPoints) {
  const VirtualScan scan = virtual_scan(wall(), at_the_wall(), small(4, 4));
  ASSERT_EQ(scan.geometry.size(), 16U);
  EXPECT_EQ(scan.geometry.kind(), GeometryKind::RangeImage);
  EXPECT_EQ(scan.geometry.viewpoint, Vec3(0, 0, 0));
  for (Index i = 0; i < 16; ++i) {
    ASSERT_EQ(scan.geometry.grid->pixel[i], i);
    const Vec3 expected(0.95 * (-0.75 + 0.5 * (i % 4)), 0.95 * (-0.75 + 0.5 * (i / 4)), 5.0);
    EXPECT_NEAR((scan.geometry.positions[i] - expected).norm(), 0.0, 1e-14) << "x right, y down, z ahead";
    const Vec3 on_wall = scan.T_mesh_scan * scan.geometry.positions[i];
    EXPECT_NEAR((on_wall - Vec3(expected.x(), -expected.y(), 0.0)).norm(), 0.0, 1e-14);
  }
}

TEST(VirtualScan, EveryPointLiesOnTheSurfaceAndIsTheFirstOne) {
  const TriangleTree torus = tree_of(testing::torus(60, 40, 1.0, 0.4));
  for (const bool random_pose : {false, true}) {
    VirtualScanOptions options = small(50, 30);
    options.random_pose = random_pose;
    options.seed = 3;
    const VirtualCamera camera = camera_on_sphere({Vec3::Zero(), 1.4}, 0.7, 0.9);
    const VirtualScan scan = virtual_scan(torus, camera, options);
    EXPECT_GT(scan.geometry.size(), 300U);
    const Vec3 eye = scan.T_mesh_scan * *scan.geometry.viewpoint;
    EXPECT_NEAR((eye - camera.T_mesh_camera.translation()).norm(), 0.0, 1e-13);
    for (const Vec3& p : scan.geometry.positions) {
      const Vec3 q = scan.T_mesh_scan * p;
      EXPECT_LT(std::sqrt(torus.closest(q).distance_sq), 1e-13);
      EXPECT_NEAR(torus.first_hit(eye, q - eye).distance, 1.0, 1e-12);
    }
  }
}

TEST(VirtualScan, TheGridShowsThePointsInOrder) {
  const VirtualScan scan =
      virtual_scan(tree_of(testing::sphere(3, 1.0)), camera_on_sphere({Vec3::Zero(), 1.2}, 0, 0), small(30, 20));
  ASSERT_EQ(scan.geometry.grid->pixel.size(), 600U);
  EXPECT_EQ(scan.geometry.grid->width, 30U);
  EXPECT_EQ(scan.geometry.grid->height, 20U);
  Index next = 0;
  for (const Index i : scan.geometry.grid->pixel) {
    if (i != kNoIndex) {
      EXPECT_EQ(i, next++);
    }
  }
  EXPECT_EQ(next, scan.geometry.size());
  EXPECT_EQ(scan.geometry.grid->pixel[0], kNoIndex) << "beside the sphere";
}

TEST(VirtualScan, NoiseIsGaussianAlongTheRay) {
  VirtualScanOptions options = small(200, 200);
  const VirtualScan exact = virtual_scan(wall(), at_the_wall(), options);
  options.noise = 0.01;
  const VirtualScan noisy = virtual_scan(wall(), at_the_wall(), options);
  ASSERT_EQ(noisy.geometry.size(), exact.geometry.size());
  double mean = 0.0, square = 0.0, fourth = 0.0;
  for (std::size_t i = 0; i < noisy.geometry.size(); ++i) {
    const Vec3 &p = noisy.geometry.positions[i], &q = exact.geometry.positions[i];
    ASSERT_NEAR(p.normalized().dot(q.normalized()), 1.0, 1e-14);
    const double error = (p.norm() - q.norm()) / options.noise;
    mean += error / 40000, square += error * error / 40000, fourth += std::pow(error, 4) / 40000;
  }
  EXPECT_NEAR(mean, 0.0, 0.02);
  EXPECT_NEAR(square, 1.0, 0.03);
  EXPECT_NEAR(fourth, 3.0, 0.2);
  options.seed = 1;
  EXPECT_NE(virtual_scan(wall(), at_the_wall(), options).geometry.positions, noisy.geometry.positions);
}

TEST(VirtualScan, RangesAreMultiplesOfTheQuantum) {
  VirtualScanOptions options = small();
  options.quantization = 0.125;
  options.noise = 0.1;
  for (const Vec3& p : virtual_scan(wall(), at_the_wall(), options).geometry.positions) {
    const double steps = p.norm() / options.quantization;
    EXPECT_NEAR(steps, std::round(steps), 1e-12);
  }
}

TEST(VirtualScan, DropoutLeavesPixelsEmpty) {
  VirtualScanOptions options = small(200, 200);
  options.dropout = 0.2;
  EXPECT_NEAR(static_cast<double>(virtual_scan(wall(), at_the_wall(), options).geometry.size()), 32000.0, 400.0);
  options.dropout = 1.0;
  const VirtualScan nothing = virtual_scan(wall(), at_the_wall(), options);
  EXPECT_EQ(nothing.geometry.size(), 0U);
  EXPECT_EQ(nothing.geometry.grid->pixel.size(), 40000U);
}

TEST(VirtualScan, FlatSurfacesAreNotSeen) {
  VirtualScanOptions options = small();
  options.max_incidence = 70.0 * kDegree;
  EXPECT_GT(virtual_scan(wall(), at_the_wall(55.0 * kDegree), options).geometry.size(), 100U);
  EXPECT_EQ(virtual_scan(wall(), at_the_wall(85.0 * kDegree), options).geometry.size(), 0U);
  EXPECT_GT(virtual_scan(wall(), at_the_wall(180.0 * kDegree), options).geometry.size(), 100U) << "from behind";
}

TEST(VirtualScan, ARandomPoseIsRigidAndItsOwnForEverySeed) {
  VirtualScanOptions options = small();
  options.random_pose = true;
  std::vector<Vec3> turned;
  for (options.seed = 0; options.seed < 20; ++options.seed) {
    const VirtualScan scan = virtual_scan(wall(), at_the_wall(), options);
    const Eigen::Matrix3d rotation = scan.T_mesh_scan.linear();
    EXPECT_TRUE((rotation.transpose() * rotation).isIdentity(1e-14));
    EXPECT_NEAR(rotation.determinant(), 1.0, 1e-14);
    turned.push_back(rotation.col(0));
    EXPECT_LT(scan.geometry.positions[0].norm(), 10.0) << "near its own origin";
  }
  for (std::size_t i = 1; i < turned.size(); ++i) EXPECT_GT((turned[i] - turned[0]).norm(), 0.01);
}

TEST(VirtualScan, TheSphereJustFitsTheImage) {
  const BoundingSphere sphere{{1, 2, 3}, 0.5};
  testing::Shape shape = testing::sphere(5, 0.5);
  for (Vec3& p : shape.positions) p += sphere.center;
  const TriangleTree tree = tree_of(shape);
  for (const auto& [width, height] : {std::pair{41, 41}, std::pair{81, 41}, std::pair{41, 81}}) {
    VirtualScanOptions options = small(width, height);
    options.max_incidence = 1.57;
    const VirtualScan scan = virtual_scan(tree, camera_on_sphere(sphere, 0.3, -0.4), options);
    int rows = 0, columns = 0;
    for (int r = 0; r < height; ++r) rows += scan.geometry.grid->pixel[r * width + width / 2] != kNoIndex;
    for (int c = 0; c < width; ++c) columns += scan.geometry.grid->pixel[height / 2 * width + c] != kNoIndex;
    EXPECT_NEAR(rows, 41, 2);
    EXPECT_NEAR(columns, 41, 2);
  }
}

TEST(VirtualScan, CamerasStandWhereTheirAnglesSay) {
  const BoundingSphere sphere{{1, 2, 3}, 2.0};
  const auto place = [&](double azimuth, double elevation) {
    const VirtualCamera camera = camera_on_sphere(sphere, azimuth * kDegree, elevation * kDegree, 0.5, 3.0);
    EXPECT_TRUE((camera.T_mesh_camera.inverse() * sphere.center).isApprox(Vec3(0, 0, 6), 1e-14)) << "looks at it";
    EXPECT_NEAR(camera.T_mesh_camera.linear().determinant(), 1.0, 1e-14);
    EXPECT_LE(camera.T_mesh_camera.linear()(1, 1), 1e-15) << "the image's y points down";
    return Vec3(camera.T_mesh_camera.translation() - sphere.center);
  };
  EXPECT_TRUE(place(0, 0).isApprox(Vec3(0, 0, 6), 1e-14));
  EXPECT_TRUE(place(90, 0).isApprox(Vec3(6, 0, 0), 1e-14));
  EXPECT_TRUE(place(0, 90).isApprox(Vec3(0, 6, 0), 1e-14));
  EXPECT_TRUE(place(30, -90).isApprox(Vec3(0, -6, 0), 1e-14));
  const std::vector<VirtualCamera> ring = ring_of_cameras(sphere, 4, 0.1, 0.2);
  ASSERT_EQ(ring.size(), 4U);
  EXPECT_EQ(ring[0].T_mesh_camera.matrix(), camera_on_sphere(sphere, 0.1, 0.2).T_mesh_camera.matrix());
  const Vec3 across = ring[0].T_mesh_camera.translation() + ring[2].T_mesh_camera.translation() - 2.0 * sphere.center;
  EXPECT_NEAR(across.x(), 0.0, 1e-13);
  EXPECT_NEAR(across.z(), 0.0, 1e-13);
}

TEST(VirtualScan, TheBoundingSphereSkipsWhatIsNoPoint) {
  const BoundingSphere sphere =
      bounding_sphere(std::vector<Vec3>{{0, 0, 0}, {4, 0, 0}, {std::nan(""), 0, 0}, {HUGE_VAL, 0, 0}});
  EXPECT_EQ(sphere.center, Vec3(2, 0, 0));
  EXPECT_EQ(sphere.radius, 2.0);
  EXPECT_EQ(bounding_sphere({}).radius, 0.0);
}

TEST(VirtualScan, RefusesWhatCannotBe) {
  const TriangleTree tree = wall();
  EXPECT_THROW((void)virtual_scan(TriangleTree(), at_the_wall()), InvalidInput);
  EXPECT_THROW((void)virtual_scan(tree, at_the_wall(), small(0, 5)), InvalidInput);
  VirtualScanOptions negative = small();
  negative.noise = -1.0;
  EXPECT_THROW((void)virtual_scan(tree, at_the_wall(), negative), InvalidInput);
  VirtualCamera camera = at_the_wall();
  for (const double angle : {0.0, -0.1, std::numbers::pi, std::nan("")}) {
    camera.field_of_view = angle;
    EXPECT_THROW((void)virtual_scan(tree, camera, small()), InvalidInput) << angle;
    EXPECT_THROW((void)camera_on_sphere({}, 0, 0, angle), InvalidInput) << angle;
  }
  EXPECT_THROW((void)camera_on_sphere({}, std::nan(""), 0), InvalidInput);
  EXPECT_THROW((void)ring_of_cameras({}, 0, 0, 0), InvalidInput);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW((void)virtual_scan(tree, at_the_wall(), small(), {1, stop.get_token(), {}}), Cancelled);
}

TEST(VirtualScan, DoesNotDependOnThreads) {
  const TriangleTree tree = tree_of(testing::sphere(4, 1.0, 0.3));
  VirtualScanOptions options = small(120, 100);
  options.noise = 0.01;
  options.dropout = 0.1;
  options.random_pose = true;
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const VirtualScan scan = virtual_scan(tree, camera_on_sphere({Vec3::Zero(), 1.0}, 1, 0), options, context);
    return std::pair(scan.geometry.positions, scan.geometry.grid->pixel);
  });
}

}  // namespace
}  // namespace shapelight
