#include "render/raster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.hpp"
#include "support/shapes.hpp"

namespace shapelight::drawing {
namespace {

/// One length unit per sample and y upwards, so that z = 0 appears where its coordinates say.
Camera plain_camera(int height) {
  Camera camera;
  camera.distance = 10.0;
  camera.center_y = height;
  return camera;
}

Frame draw(const Geometry& geometry, int width, int height, const Paint& paint = {}) {
  Surface surface;
  surface.triangles = geometry.triangles;
  surface.normals = triangle_normals(geometry.positions, geometry.triangles, {});
  return rasterize(geometry, surface, paint, plain_camera(height), width, height, {});
}

TEST(Rasterize, CoversTheSamplesWhoseCentresLieInside) {
  Geometry geometry;
  geometry.positions = {{1, 1, 0}, {8, 2, 0}, {3, 7.5, 0}};
  const auto side = [&](std::size_t i, std::size_t j, double x, double y) {
    const Vec3 &a = geometry.positions[i], &b = geometry.positions[j];
    return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
  };
  for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 2, 1}}) {  // either winding
    geometry.triangles = {t};
    const Frame frame = draw(geometry, 10, 9);
    for (int row = 0; row < 9; ++row) {
      for (int column = 0; column < 10; ++column) {
        const double x = column + 0.5, y = 9 - (row + 0.5);
        const bool inside = side(0, 1, x, y) > 0 && side(1, 2, x, y) > 0 && side(2, 0, x, y) > 0;
        EXPECT_EQ(frame.at(column, row).nearness > 0.0F, inside) << column << "," << row;
      }
    }
  }
}

/// A square of 16 x 16 samples around a fan of triangles whose edges run through sample centres.
TEST(Rasterize, TrianglesOfASurfaceShareNoSampleAndLeaveNone) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Geometry geometry;
    geometry.positions = {{2, 2, 0},   {10.5, 2, 0}, {18, 2, 0}, {18, 9.5, 0},
                          {18, 18, 0}, {7.5, 18, 0}, {2, 18, 0}, {2, 5.5, 0}};
    const double x = 4 + std::floor(12 * random01(seed, 0, 0)) + 0.5,
                 y = 4 + std::floor(12 * random01(seed, 0, 1)) + 0.5;
    geometry.positions.push_back({x, y, 0});
    std::vector<int> times(400, 0);
    for (Index i = 0; i < 8; ++i) {
      geometry.triangles = {{8, i, (i + 1) % 8}};
      if (i % 2 == 1) std::swap(geometry.triangles[0][1], geometry.triangles[0][2]);
      const Frame frame = draw(geometry, 20, 20);
      for (std::size_t k = 0; k < times.size(); ++k) times[k] += frame.fragments[k].nearness > 0.0F ? 1 : 0;
    }
    for (int row = 0; row < 20; ++row) {
      for (int column = 0; column < 20; ++column) {
        const bool inside = row >= 2 && row < 18 && column >= 2 && column < 18;
        EXPECT_EQ(times[static_cast<std::size_t>(row * 20 + column)], inside ? 1 : 0)
            << seed << ": " << column << "," << row;
      }
    }
  }
}

TEST(Rasterize, KeepsTheNearerSurfaceAtItsDepth) {
  Geometry geometry;  // a slope z = (x - 5) / 5 through a flat square at z = 0
  geometry.positions = {{-5, -5, 0}, {25, -5, 0}, {-5, 25, 0}, {-5, -5, -2}, {25, -5, 4}, {-5, 25, -2}};
  geometry.triangles = {{0, 1, 2}, {3, 4, 5}};
  std::vector<Color> colors(6, Color{0, 0, 1});
  std::fill_n(colors.begin(), 3, Color{1, 0, 0});
  const Frame frame = draw(geometry, 10, 10, {colors, {}, false, 0.0});
  for (int column = 0; column < 10; ++column) {
    // A ray through the sample: x = seen (10 - z) / 10 with z = (x - 5) / 5 meets the slope at x.
    const double seen = column + 0.5;
    const double x = seen * 1.1 / (1.0 + 0.02 * seen);
    const double z = (x - 5.0) / 5.0;
    const Fragment& fragment = frame.at(column, 5);
    EXPECT_EQ(fragment.color[2] > 128, z > 0) << column;
    EXPECT_NEAR(fragment.nearness, 10.0 / (10.0 - std::max(z, 0.0)), 2e-4) << column;
  }
}

TEST(Rasterize, InterpolatesColorsInSpaceOrTakesTheNearest) {
  Geometry geometry;
  geometry.positions = {{0, 0, 0}, {40, 0, 0}, {0, 40, 0}};
  geometry.triangles = {{0, 1, 2}};
  const std::vector<Color> colors = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  const Frame blend = draw(geometry, 40, 40, {colors, {}, false, 0.0});
  const Frame flat = draw(geometry, 40, 40, {colors, {}, true, 0.0});
  for (int column = 0; column < 39; ++column) {
    EXPECT_NEAR(blend.at(column, 39).color[0], 255 * (column + 0.5) / 40, 1.0);
    EXPECT_EQ(flat.at(column, 39).color[0], column < 20 ? 0 : 255);
  }
}

TEST(Rasterize, SkipsTrianglesAndPointsThatAreNotFinite) {
  Geometry geometry;
  geometry.positions = {{0, 0, 0}, {9, 0, 0}, {0, std::nan(""), 0}, {0, 9, std::numeric_limits<double>::infinity()}};
  geometry.triangles = {{0, 1, 2}, {0, 1, 3}};
  for (const Fragment& fragment : draw(geometry, 10, 10).fragments) EXPECT_EQ(fragment.nearness, 0.0F);
}

TEST(Rasterize, DrawsADiscOfTheAskedRadiusInItsPlane) {
  Geometry geometry;
  geometry.positions = {{20, 20, 0}};
  Surface surface;
  surface.normals = {Vec3f(1, 0, 1).normalized()};
  const Frame frame = rasterize(geometry, surface, {{}, {1, 1, 1}, false, 10.0}, plain_camera(40), 40, 40, {});
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      const double dx = column + 0.5 - 20, dy = row + 0.5 - 20;
      const bool inside = 2 * dx * dx + dy * dy < 100;  // tilted by 45 degrees: z = -x
      EXPECT_EQ(frame.at(column, row).nearness > 0.0F, inside) << column << "," << row;
    }
  }
  EXPECT_LT(frame.at(24, 20).nearness, frame.at(15, 20).nearness);
}

TEST(Camera, ProjectsBackAndForthAndNothingBehindTheEye) {
  Camera camera = plain_camera(40);
  camera.scale = 3.0;
  camera.center_x = 20.0;
  const Vec3 point(2.0, 1.5, -4.0);
  const ScreenPoint p = camera.project(point);
  const Vec3f back =
      camera.unproject(static_cast<float>(p.x) / kSubpixels, static_cast<float>(p.y) / kSubpixels, p.nearness);
  EXPECT_LT((back.cast<double>() - point).norm(), 2e-3);
  EXPECT_EQ(camera.project({0, 0, 10}).nearness, 0.0F);
  EXPECT_EQ(camera.project({1, 2, 15}).nearness, 0.0F);
  EXPECT_EQ(camera.project({std::nan(""), 0, 0}).nearness, 0.0F);
  EXPECT_EQ(camera.project({1e9, 0, 0}).nearness, 0.0F);
}

TEST(TriangulateGrid, IsCutWhereTheDepthJumps) {
  Geometry geometry;  // 6 x 3 pixels, one length unit apart; the right half lies far behind; one pixel is empty
  RangeGrid grid{6, 3, {}};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 6; ++column) {
      grid.pixel.push_back(static_cast<Index>(geometry.positions.size()));
      geometry.positions.push_back({double(column), double(-row), column < 3 ? 0.0 : -50.0});
    }
  }
  grid.pixel[0] = kNoIndex;
  geometry.grid = grid;
  const auto triangles = triangulate_grid(geometry, {});
  EXPECT_EQ(triangles.size(), 2U * 2U * 4U - 1U);
  for (const Triangle& t : triangles) {
    for (const Index i : t) {
      EXPECT_NE(i, 0U);
      EXPECT_EQ(geometry.positions[i].z(), geometry.positions[t[0]].z());
    }
  }
}

TEST(TriangleNormals, PointAwayFromTheCentreOfASphere) {
  const auto sphere = testing::sphere(3, 2.0);
  const auto normals = triangle_normals(sphere.positions, sphere.triangles, {});
  for (std::size_t i = 0; i < normals.size(); ++i) {
    EXPECT_GT(normals[i].cast<double>().dot(sphere.positions[i].normalized()), 0.9995);
  }
}

}  // namespace
}  // namespace shapelight::drawing
