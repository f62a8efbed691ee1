#include "shapelight/sample/normal_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "shapelight/core/error.hpp"
#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

SurfaceGraph with_normals(const std::vector<Vec3>& normals) {
  return test::point_graph(test::ellipsoid_graph(normals.size()).position, normals);
}

TEST(NormalSpaceSampling, DrawsEvenlyOverDirections) {
  // 900 normals up, 60 along x, 40 along y, each with a little noise that must not split a direction into cells.
  std::vector<Vec3> normals;
  for (std::size_t i = 0; i < 1000; ++i) {
    const Vec3 axis = i < 900 ? Vec3::UnitZ() : i < 960 ? Vec3::UnitX() : Vec3(-Vec3::UnitY());
    const Vec3 noise(random01(1, 0, i) - 0.5, random01(1, 1, i) - 0.5, random01(1, 2, i) - 0.5);
    normals.push_back((axis + 0.1 * noise).normalized());
  }
  const SurfaceGraph graph = with_normals(normals);
  const std::vector<Index> chosen = sample_normal_space(graph, test::all_vertices(graph), {.count = 90});
  auto between = [&](Index low, Index high) {
    return std::count_if(chosen.begin(), chosen.end(), [&](Index v) { return v >= low && v < high; });
  };
  EXPECT_EQ(between(0, 900), 30);
  EXPECT_EQ(between(900, 960), 30);
  EXPECT_EQ(between(960, 1000), 30);
}

TEST(NormalSpaceSampling, CellsHaveEqualArea) {
  // With a point in every small patch of the sphere, no cell runs dry early: one turn of all 82 cells takes one point
  // each, so a sample of 82 touches every part of the sphere.
  const SurfaceGraph graph = test::ellipsoid_graph(20000, Vec3::Ones());
  const std::vector<Index> chosen = sample_normal_space(graph, test::all_vertices(graph), {.count = 82});
  // Equal cells of 4 pi / 82 are at most about 0.6 across, and each holds a sample.
  EXPECT_LT(test::brute_coverage(graph.normal,
                                 [&] {
                                   std::vector<Vec3> normals;
                                   for (const Index v : chosen) normals.push_back(graph.normal[v]);
                                   return normals;
                                 }()),
            0.75);
  // Uniform directions, so equal areas hold equally many points: drawing nearly all leaves the few cells with the
  // largest surplus, which deviate from 20000 / 82 = 244 by noise only (sd 15.5).
  const std::vector<Index> most = sample_normal_space(graph, test::all_vertices(graph), {.count = 82 * 180});
  std::vector<std::uint8_t> used(graph.size(), 0);
  for (const Index v : most) used[v] = 1;
  std::array<int, 8> left{};
  for (Index v = 0; v < graph.size(); ++v) {
    const Vec3& n = graph.normal[v];
    if (!used[v]) ++left[(n.x() > 0.0) + 2 * (n.y() > 0.0) + 4 * (n.z() > 0.0)];
  }
  const auto [low, high] = std::minmax_element(left.begin(), left.end());
  EXPECT_LT(*high, 1.35 * *low);
}

TEST(NormalSpaceSampling, DrawsCellsInRandomOrder) {
  std::vector<Vec3> normals(30, Vec3::UnitZ());
  for (std::size_t i = 10; i < 30; ++i) normals[i] = i < 20 ? Vec3::UnitX() : Vec3::UnitY();
  const SurfaceGraph graph = with_normals(normals);
  std::array<int, 3> first{};
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    ++first[sample_normal_space(graph, test::all_vertices(graph), {.count = 1}, {.seed = seed})[0] / 10];
  }
  for (const int count : first) EXPECT_NEAR(count, 100, 30);
}

TEST(NormalSpaceSampling, IsARanking) {
  const SurfaceGraph graph = test::ellipsoid_graph(500);
  const std::vector<Index> all = test::all_vertices(graph);
  const std::vector<Index> large = sample_normal_space(graph, all, {.count = 300});
  const std::vector<Index> small = sample_normal_space(graph, all, {.count = 70});
  EXPECT_TRUE(std::equal(small.begin(), small.end(), large.begin()));
}

TEST(NormalSpaceSampling, VerticesWithoutNormalComeLast) {
  std::vector<Vec3> normals(20, Vec3::UnitX());
  for (std::size_t i = 0; i < 10; ++i) normals[i] = Vec3::Zero();
  const SurfaceGraph graph = with_normals(normals);
  const std::vector<Index> chosen = sample_normal_space(graph, test::all_vertices(graph), {.count = 15});
  for (std::size_t k = 0; k < 15; ++k) EXPECT_EQ(chosen[k] < 10, k >= 10) << k;
}

TEST(NormalSpaceSampling, RefusesPointsWithoutAnyNormal) {
  const SurfaceGraph graph = with_normals(std::vector<Vec3>(5, Vec3::Zero()));
  EXPECT_THROW((void)sample_normal_space(graph, test::all_vertices(graph), {.count = 2}), InvalidInput);
}

}  // namespace
}  // namespace shapelight
