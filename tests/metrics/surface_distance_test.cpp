#include "shapelight/metrics/surface_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "metrics/surface_samples.hpp"
#include "shapelight/core/error.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

TriangleMesh mesh_of(const testing::Shape& shape) { return {shape.positions, shape.triangles}; }

TriangleMesh moved(TriangleMesh mesh, const Vec3& shift, double scale = 1.0) {
  for (Vec3& p : mesh.positions) p = scale * p + shift;
  return mesh;
}

// A unit square of n x n cells.
TriangleMesh square(Index n) {
  testing::Shape shape;
  for (Index r = 0; r <= n; ++r) {
    for (Index c = 0; c <= n; ++c) shape.add(Vec3(c, r, 0.0) / static_cast<double>(n), Vec3::UnitZ(), 0, 0);
  }
  testing::add_grid_faces(shape, n + 1, n + 1, false, false);
  return mesh_of(shape);
}

std::array<double, 14> numbers_of(const SurfaceDistance& d) {
  return {d.forward.mean,         d.forward.rms,         d.forward.max,    d.backward.mean,
          d.backward.rms,         d.backward.max,        d.symmetric.mean, d.symmetric.rms,
          d.symmetric.max,        d.vertex_rms,          d.diagonal,       static_cast<double>(d.samples),
          d.normal_deviation.rms, d.normal_deviation.p95};
}

void expect_all(const DistanceSummary& summary, double value, double tolerance) {
  EXPECT_NEAR(summary.mean, value, tolerance);
  EXPECT_NEAR(summary.rms, value, tolerance);
  EXPECT_NEAR(summary.max, value, tolerance);
}

TEST(SurfaceDistance, OfAPlaneMovedIsTheWay) {
  const TriangleMesh plane = square(10);
  const SurfaceDistance d = measure_surface_distance(plane, moved(plane, Vec3(0, 0, 0.25)), {.samples = 5000});
  for (const DistanceSummary& s : {d.forward, d.backward, d.symmetric}) expect_all(s, 0.25, 1e-15);
  EXPECT_NEAR(d.vertex_rms, 0.25, 1e-15);
  EXPECT_EQ(d.diagonal, std::sqrt(2.0));
  EXPECT_EQ(d.normal_deviation.rms, 0.0);
  EXPECT_EQ(d.samples, 5000U);
}

TEST(SurfaceDistance, OfAMeshToItselfIsZero) {
  const Geometry armadillo = testing::read_data("meshes/armadillo.ply");
  const TriangleMesh mesh{armadillo.positions, armadillo.triangles};
  const SurfaceDistance d = measure_surface_distance(mesh, mesh, {.samples = 20000});
  EXPECT_LT(d.symmetric.max, 1e-15 * d.diagonal);
  EXPECT_EQ(d.vertex_rms, 0.0);
  EXPECT_LT(d.normal_deviation.p95, 1e-9);
}

TEST(SurfaceDistance, FarOffsetsCostNoDigits) {
  const TriangleMesh ball = mesh_of(testing::sphere(4, 1.0)), dented = mesh_of(testing::sphere(3, 1.0));
  const Vec3 utm(448262.0, 5411932.0, 512.0);
  const SurfaceDistance here = measure_surface_distance(ball, dented, {.samples = 20000});
  const SurfaceDistance far = measure_surface_distance(moved(ball, utm), moved(dented, utm), {.samples = 20000});
  EXPECT_NEAR(far.symmetric.rms, here.symmetric.rms, 1e-8);
  const SurfaceDistance same = measure_surface_distance(moved(ball, utm), moved(ball, utm), {.samples = 20000});
  EXPECT_LT(same.symmetric.max, 1e-15);
}

TEST(SurfaceDistance, OfSpheresIsTheDifferenceOfRadii) {
  const TriangleMesh ball = mesh_of(testing::sphere(5, 1.0));  // chords sag by 0.0003
  const SurfaceDistance d = measure_surface_distance(ball, moved(ball, Vec3::Zero(), 1.5), {.samples = 30000});
  for (const DistanceSummary& s : {d.forward, d.backward, d.symmetric}) expect_all(s, 0.5, 1e-3);
  EXPECT_LT(d.normal_deviation.rms, 0.05);
}

TEST(SurfaceDistance, OfASphereToItsRefinement) {
  // The flat triangles of the coarse one sag under the sphere, deepest at a vertex of the fine one.
  const TriangleMesh coarse = mesh_of(testing::sphere(3, 1.0)), fine = mesh_of(testing::sphere(6, 1.0));
  const SurfaceDistance d = measure_surface_distance(fine, coarse, {.samples = 100000});
  double sag = 0.0;
  for (const Vec3& p : fine.positions) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& t : coarse.triangles) {
      const Vec3 &a = coarse.positions[t[0]], &b = coarse.positions[t[1]], &c = coarse.positions[t[2]];
      if ((a - p).squaredNorm() > 0.25) continue;
      nearest = std::min(nearest, (closest_point_on_triangle(p, a, b, c) - p).norm());
    }
    sag = std::max(sag, nearest);
  }
  EXPECT_NEAR(d.forward.max, sag, 1e-15);
  EXPECT_NEAR(d.forward.rms, d.backward.rms, 0.02 * d.forward.rms);
  EXPECT_GT(d.normal_deviation.p95, d.normal_deviation.rms);
}

// The rms over a triangle of a linear height has a closed form, so a tilted plane tests the samples' uniformity.
TEST(SurfaceDistance, OfATiltedPlane) {
  const double slope = 0.01;
  TriangleMesh tilted = square(1);
  for (Vec3& p : tilted.positions) p = Vec3(p.x(), p.y(), slope * p.x());
  TriangleMesh wide = moved(square(3), Vec3(-1, -1, 0), 3.0);
  const SurfaceDistance d = measure_surface_distance(tilted, wide, {.samples = 50000});
  EXPECT_NEAR(d.forward.mean, slope / 2.0, 1e-6);
  EXPECT_NEAR(d.forward.rms, slope / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(d.forward.max, slope, 1e-15);
  EXPECT_NEAR(d.vertex_rms, slope / std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(d.normal_deviation.rms, std::atan(slope), 1e-7);
  EXPECT_NEAR(d.normal_deviation.p95, std::atan(slope), 1e-7);
  EXPECT_NEAR(d.symmetric.mean, 0.5 * (d.forward.mean + d.backward.mean), 1e-15);
  EXPECT_NEAR(d.symmetric.rms, std::hypot(d.forward.rms, d.backward.rms) / std::sqrt(2.0), 1e-15);
  EXPECT_EQ(d.symmetric.max, d.backward.max);
  EXPECT_GT(d.backward.max, std::sqrt(2.0) - 0.01);
}

TEST(SurfaceDistance, TheMaximumKnowsVerticesAndSamples) {
  TriangleMesh spike = square(40);
  spike.positions[41 * 20 + 20].z() = 0.7;  // in the middle; the ten samples miss it
  const SurfaceDistance d = measure_surface_distance(square(1), spike, {.samples = 10});
  EXPECT_NEAR(d.backward.max, 0.7, 1e-15);
  TriangleMesh roof = square(2);
  roof.positions[4].z() = 0.7;  // the vertices of the reference are at its corners
  const double below = measure_surface_distance(square(1), roof, {.samples = 1000}).forward.max;
  EXPECT_GT(below, 0.3);
  EXPECT_LT(below, 0.7);
}

TEST(SurfaceDistance, VerticesWithoutTriangleAreNoSurface) {
  TriangleMesh plane = square(4);
  const SurfaceDistance before = measure_surface_distance(square(4), plane, {.samples = 100});
  plane.positions.emplace_back(0.5, 0.5, 9.0);
  plane.positions.emplace_back(std::nan(""), 0.0, 0.0);
  EXPECT_EQ(numbers_of(measure_surface_distance(square(4), plane, {.samples = 100})), numbers_of(before));
}

TEST(SurfaceDistance, DegenerateTrianglesHaveNoNormal) {
  TriangleMesh flipped = moved(square(4), Vec3(0, 0, 0.4));
  for (Triangle& t : flipped.triangles) std::swap(t[1], t[2]);
  flipped.positions.insert(flipped.positions.end(), {{0, 0.5, 0}, {0.5, 0.5, 0}, {1, 0.5, 0}});
  flipped.triangles.insert(flipped.triangles.begin(), {{25, 26, 27}, {3, 3, 3}});
  const SurfaceDistance d = measure_surface_distance(square(4), flipped, {.samples = 20000});
  EXPECT_LT(d.forward.mean, 0.3);  // the line in the middle is the nearest to many
  EXPECT_NEAR(d.normal_deviation.rms, std::numbers::pi, 1e-6);
}

TEST(SurfaceDistance, OppositeFacesDeviateByHalfATurn) {
  TriangleMesh flipped = square(2);
  for (Triangle& t : flipped.triangles) std::swap(t[1], t[2]);
  const SurfaceDistance d = measure_surface_distance(square(2), flipped, {.samples = 100});
  EXPECT_NEAR(d.normal_deviation.rms, std::numbers::pi, 1e-6);
}

TEST(SurfaceDistance, RefusesWhatItCannotMeasure) {
  const TriangleMesh good = square(2);
  TriangleMesh flat = good, broken = good, wrong = good;
  for (Vec3& p : flat.positions) p.y() = 0.0;
  broken.positions[4].x() = std::nan("");
  wrong.triangles[3][1] = 9;
  for (const TriangleMesh& bad : {TriangleMesh{}, flat, broken, wrong}) {
    for (const bool first : {true, false}) {
      try {
        (void)measure_surface_distance(first ? bad : good, first ? good : bad);
        ADD_FAILURE() << "accepted";
      } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find(first ? "reference" : "test"), std::string::npos) << error.what();
      }
    }
  }
}

TEST(SurfaceDistance, DefaultNumberOfSamples) {
  EXPECT_EQ(measure_surface_distance(square(2), square(3)).samples, 100000U);
  EXPECT_EQ(measure_surface_distance(square(2), square(110)).samples, 123210U);
}

TEST(SurfaceDistance, DoesNotDependOnThreads) {
  const TriangleMesh a = mesh_of(testing::sphere(5, 1.0)), b = mesh_of(testing::sphere(4, 1.0, 0.3));
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    return numbers_of(measure_surface_distance(a, b, {.samples = 30000, .seed = 5}, context));
  });
  testing::expect_same_for_any_number_of_threads(
      [&](const RunContext& context) { return vertex_distances(a, TriangleTree(b, context), context); });
  EXPECT_NE(numbers_of(measure_surface_distance(a, b, {.samples = 3000, .seed = 6})),
            numbers_of(measure_surface_distance(a, b, {.samples = 3000, .seed = 5})));
}

TEST(SurfaceDistance, StopsAndReports) {
  const TriangleMesh ball = mesh_of(testing::sphere(3, 1.0));
  for (const double when : {0.0, 0.1, 0.55}) {
    std::stop_source source;
    RunContext context{.max_threads = 2, .stop = source.get_token()};
    context.progress = [&](double fraction, std::string_view) {
      if (fraction >= when) source.request_stop();
    };
    EXPECT_THROW((void)measure_surface_distance(ball, ball, {}, context), Cancelled);
  }
  double last = 0.0;
  RunContext context;
  context.progress = [&](double fraction, std::string_view) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  (void)measure_surface_distance(ball, ball, {.samples = 10}, context);
  EXPECT_EQ(last, 1.0);
}

TEST(VertexDistances, OfEveryVertex) {
  TriangleMesh points;
  points.positions = {{0.5, 0.5, 2.0}, {0.25, 0.75, 0.0}, {3.0, 1.0, 0.0}, {std::nan(""), 0.0, 0.0}};
  const std::vector<double> d = vertex_distances(points, TriangleTree(square(3)));
  EXPECT_EQ(d[0], 2.0);
  EXPECT_NEAR(d[1], 0.0, 1e-16);
  EXPECT_EQ(d[2], 2.0);
  EXPECT_TRUE(std::isnan(d[3]));
}

TEST(SurfaceSamples, EveryTriangleGetsItsShare) {
  TriangleMesh mesh = square(8);
  for (Vec3& p : mesh.positions) p.x() = std::pow(p.x(), 3.0);  // areas from 1 to 169
  const std::size_t count = 20000;
  const SurfaceSamples samples(mesh, count, 1, 0);
  EXPECT_NEAR(samples.area(), 1.0, 1e-12);
  std::vector<double> share(mesh.triangles.size(), 0.0);
  Index near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const SurfaceSamples::Sample sample = samples.at(k, near);
    EXPECT_LE(samples.triangle_before(k), sample.triangle);
    EXPECT_EQ(samples.at(k, samples.triangle_before(k)).point, sample.point);
    near = sample.triangle;
    share[sample.triangle] += 1.0;
    const Triangle& t = mesh.triangles[sample.triangle];
    const Vec3 on =
        closest_point_on_triangle(sample.point, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
    EXPECT_LT((on - sample.point).norm(), 1e-15);
  }
  for (Index t = 0; t < share.size(); ++t) EXPECT_NEAR(share[t], 0.5 * area_normal(mesh, t).norm() * count, 2.0);
}

}  // namespace
}  // namespace shapelight
