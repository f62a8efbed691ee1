#include "shapelight/sample/voxel.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

#include "shapelight/core/error.hpp"
#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

using Cell = std::array<int, 3>;

TEST(VoxelSampling, TakesThePointNearestToTheCentroidOfEveryCell) {
  const SurfaceGraph graph = test::ellipsoid_graph(2000);
  const double spacing = 0.17;
  const Vec3 corner = bounding_box(graph.position).center() - Vec3::Constant(20.5 * spacing);
  std::map<Cell, std::vector<Index>> cells;
  for (Index v = 0; v < graph.size(); ++v) {
    const Vec3 q = (graph.position[v] - corner) / spacing;
    cells[{static_cast<int>(q[0]), static_cast<int>(q[1]), static_cast<int>(q[2])}].push_back(v);
  }
  std::set<Index> expected;
  for (const auto& [cell, members] : cells) {
    Vec3 centroid = Vec3::Zero();
    for (const Index v : members) centroid += graph.position[v] / static_cast<double>(members.size());
    expected.insert(*std::min_element(members.begin(), members.end(), [&](Index a, Index b) {
      // Two points are equally far from their centroid up to rounding; then the first one counts.
      return (graph.position[a] - centroid).norm() < (1.0 - 1e-9) * (graph.position[b] - centroid).norm();
    }));
  }
  const std::vector<Index> chosen = sample_voxel(graph, test::all_vertices(graph), {.spacing = spacing});
  EXPECT_EQ(std::set<Index>(chosen.begin(), chosen.end()), expected);
  EXPECT_EQ(chosen.size(), cells.size());
}

TEST(VoxelSampling, OneCellForASpacingBeyondTheExtent) {
  const SurfaceGraph graph = test::ellipsoid_graph(100);
  EXPECT_EQ(sample_voxel(graph, test::all_vertices(graph), {.spacing = 1e9}).size(), 1U);
}

TEST(VoxelSampling, RefusesCellsTooSmallToNumber) {
  const SurfaceGraph graph = test::ellipsoid_graph(100);
  EXPECT_THROW((void)sample_voxel(graph, test::all_vertices(graph), {.spacing = 1e-9}), InvalidInput);
}

TEST(VoxelSampling, AFarOriginChangesNothing) {
  // A power of two and positions on a fine binary grid: the shifted points are exact.
  SurfaceGraph graph = test::ellipsoid_graph(1000);
  for (Vec3& p : graph.position) p = (p * 0x1.0p20).array().round().matrix() * 0x1.0p-20;
  const std::vector<Index> expected = sample_voxel(graph, test::all_vertices(graph), {.count = 100});
  for (Vec3& p : graph.position) p += Vec3(0x1.0p22, -0x1.0p22, 0.0);
  EXPECT_EQ(sample_voxel(graph, test::all_vertices(graph), {.count = 100}), expected);
}

}  // namespace
}  // namespace shapelight
