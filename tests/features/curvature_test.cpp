#include "shapelight/features/curvature.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

constexpr CurvatureMethod kMethods[] = {CurvatureMethod::Taubin, CurvatureMethod::Quadric,
                                        CurvatureMethod::NormalField};

CurvatureOptions with(CurvatureMethod method, int passes = 0) {
  CurvatureOptions options;
  options.method = method;
  options.smoothing_passes = passes;
  return options;
}

// Vertices at least `rings` steps from the border of the surface.
std::vector<bool> inner_vertices(const SurfaceGraph& graph, int rings) {
  std::vector<bool> inner(graph.size());
  RingCollector collector(graph);
  for (Index i = 0; i < graph.size(); ++i) {
    const auto near = collector.collect(i, rings, 1000);
    inner[i] = std::none_of(near.begin(), near.end(), [&](Index j) { return graph.boundary[j] != 0; });
  }
  return inner;
}

// Largest error of both principal curvatures over inner vertices.
double worst_error(const Shape& shape, const CurvatureOptions& options) {
  const SurfaceGraph graph = graph_of_mesh(shape);
  const Curvatures found = estimate_curvatures(graph, options);
  const std::vector<bool> inner = inner_vertices(graph, 3);
  double worst = 0.0;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (!inner[i]) continue;
    worst = std::max({worst, std::abs(found.k1[i] - shape.k1[i]), std::abs(found.k2[i] - shape.k2[i])});
  }
  return worst;
}

TEST(Curvature, SphereIsConvexAndPositiveEverywhere) {
  for (const CurvatureMethod method : kMethods) {
    EXPECT_LT(worst_error(sphere(4, 2.0), with(method)), 0.03 * 0.5) << enum_name(method);
    EXPECT_LT(worst_error(sphere(4, 2.0), with(method, 2)), 0.03 * 0.5) << enum_name(method);
  }
  EXPECT_LT(worst_error(sphere(4, 2.0, 0.2), with(CurvatureMethod::Taubin, 1)), 0.25 * 0.5);
}

TEST(Curvature, PlaneIsFlatAndStillHasDirections) {
  const SurfaceGraph graph = graph_of_mesh(plane(12, 0.1, 0.2));
  for (const CurvatureMethod method : kMethods) {
    const Curvatures found = estimate_curvatures(graph, with(method, 1));
    for (std::size_t i = 0; i < graph.size(); ++i) {
      EXPECT_NEAR(found.k1[i], 0.0, 1e-9);
      EXPECT_NEAR(found.k2[i], 0.0, 1e-9);
      EXPECT_NEAR(found.direction1[i].norm(), 1.0, 1e-12);
      EXPECT_NEAR(found.direction1[i].dot(graph.normal[i]), 0.0, 1e-12);
    }
  }
}

TEST(Curvature, CylinderBendsAcrossItsAxisOnly) {
  const Shape shape = cylinder(48, 30, 0.5);
  const SurfaceGraph graph = graph_of_mesh(shape);
  const std::vector<bool> inner = inner_vertices(graph, 3);
  for (const CurvatureMethod method : kMethods) {
    EXPECT_LT(worst_error(shape, with(method)), 0.02 * 2.0) << enum_name(method);
    const Curvatures found = estimate_curvatures(graph, with(method, 1));
    for (std::size_t i = 0; i < graph.size(); ++i) {
      EXPECT_TRUE(!inner[i] || std::abs(found.direction1[i].z()) < 1e-2) << enum_name(method);
    }
  }
}

TEST(Curvature, SaddleBendsBothWays) {
  for (const CurvatureMethod method : kMethods) {
    EXPECT_LT(worst_error(saddle(41, 0.01), with(method)), 0.03) << enum_name(method);
  }
}

TEST(Curvature, BowlSeenFromInsideIsNegative) {
  EXPECT_LT(worst_error(height_field("bowl", 41, 0.01, 2.0, 1.0), with(CurvatureMethod::Taubin)), 0.05);
  EXPECT_LT(worst_error(height_field("bowl", 41, 0.01, 2.0, 1.0, 0.25), with(CurvatureMethod::Quadric)), 0.1);
}

TEST(Curvature, TorusChangesSignInside) {
  for (const CurvatureMethod method : kMethods) {
    EXPECT_LT(worst_error(torus(120, 48, 1.0, 0.4), with(method)), 0.06 * 2.5) << enum_name(method);
  }
}

TEST(Curvature, FollowsRotationAndScale) {
  const Shape shape = torus(40, 20, 1.0, 0.4);
  const SurfaceGraph graph = graph_of_mesh(shape);
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, -3).normalized()).toRotationMatrix();
  const SurfaceGraph other = moved(graph, rotation, 1000.0, Vec3(5, 6, 7));
  for (const CurvatureMethod method : kMethods) {
    const Curvatures a = estimate_curvatures(graph, with(method, 2));
    const Curvatures b = estimate_curvatures(other, with(method, 2));
    for (std::size_t i = 0; i < graph.size(); ++i) {
      EXPECT_NEAR(b.k1[i] * 1000.0, a.k1[i], 1e-6);
      EXPECT_NEAR(b.k2[i] * 1000.0, a.k2[i], 1e-6);
      EXPECT_NEAR(std::abs(b.direction1[i].dot(rotation * a.direction1[i])), 1.0, 1e-6);
    }
  }
}

TEST(Curvature, SmoothingAndWiderFitsTameNoise) {
  const Shape clean = sphere(4, 1.0);
  const double h = graph_of_mesh(clean).mean_edge_length;
  const Shape noisy = with_noise(clean, 0.1 * h);
  const auto error = [&](const CurvatureOptions& options) {
    const Curvatures found = estimate_curvatures(graph_of_mesh(noisy), options);
    double sum = 0.0;
    for (const double k : found.k1) sum += std::abs(k - 1.0);
    return sum / static_cast<double>(found.k1.size());
  };
  const double raw = error(with(CurvatureMethod::Taubin, 0));
  EXPECT_LT(error(with(CurvatureMethod::Taubin, 1)), 0.6 * raw);
  EXPECT_LT(error(with(CurvatureMethod::Taubin, 4)), error(with(CurvatureMethod::Taubin, 1)));
  EXPECT_LT(error(with(CurvatureMethod::NormalField, 0)), 0.6 * raw);
}

TEST(Curvature, CloudsOfCleanPointsAgreeWithTheSphere) {
  const SurfaceGraph graph = graph_of_points(sphere(3, 1.0, 0.2), 12);
  for (const CurvatureMethod method : {CurvatureMethod::Quadric, CurvatureMethod::NormalField}) {
    const Curvatures found = estimate_curvatures(graph, with(method));
    for (std::size_t i = 0; i < graph.size(); ++i) {
      EXPECT_NEAR(found.k1[i], 1.0, 0.05) << enum_name(method);
      EXPECT_NEAR(found.k2[i], 1.0, 0.05) << enum_name(method);
    }
  }
}

TEST(Curvature, EmptyIsolatedAndCollinear) {
  const std::vector<Vec3> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  for (const CurvatureMethod method : kMethods) {
    EXPECT_TRUE(estimate_curvatures(isolated(0), with(method, 1)).k1.empty());
    for (const std::size_t n : {1U, 3U}) {
      const Curvatures found = estimate_curvatures(isolated(n), with(method, 1));
      EXPECT_EQ(found.k1, std::vector<double>(n, 0.0));
      EXPECT_EQ(found.direction1, std::vector<Vec3>(n, Vec3::Zero()));
    }
    const Curvatures found = estimate_curvatures(graph_of_edges(line, {{0, 1}, {1, 2}, {2, 3}}), with(method, 1));
    for (std::size_t i = 0; i < line.size(); ++i) {
      EXPECT_TRUE(std::isfinite(found.k1[i]) && std::isfinite(found.k2[i])) << enum_name(method);
      EXPECT_GE(found.k1[i], found.k2[i]);
    }
  }
}

TEST(Curvature, RefusesOptionsOutOfRange) {
  EXPECT_THROW(static_cast<void>(estimate_curvatures(isolated(1), with(CurvatureMethod::Taubin, -1))), InvalidInput);
}

TEST(Curvature, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(sphere(5, 1.0), 0.002));
  for (const CurvatureMethod method : kMethods) {
    expect_same_for_any_number_of_threads([&](const RunContext& context) {
      const Curvatures found = estimate_curvatures(graph, with(method, 2), context);
      return std::make_tuple(found.k1, found.k2, found.direction1);
    });
  }
}

TEST(Curvedness, IsTheRootMeanSquare) {
  EXPECT_DOUBLE_EQ(curvedness(3.0, 3.0), 3.0);
  EXPECT_DOUBLE_EQ(curvedness(1.0, -1.0), 1.0);
  EXPECT_DOUBLE_EQ(curvedness(7.0, 1.0), 5.0);
}

}  // namespace
}  // namespace shapelight
