#include "shapelight/sample/stratified.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "sample/spread.hpp"
#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

TEST(StratifiedSampling, AtMostOnePerStratumAndNoneTooClose) {
  const SurfaceGraph graph = test::ellipsoid_graph(3000);
  const double spacing = 0.2;
  const std::vector<Vec3> samples =
      test::positions_of(graph, sample_stratified(graph, test::all_vertices(graph), {.spacing = spacing}));
  const Vec3 corner = bounding_box(graph.position).center() - Vec3::Constant(20.5 * spacing);
  std::set<std::array<int, 3>> cells;
  for (const Vec3& p : samples) {
    const Vec3 q = (p - corner) / spacing;
    EXPECT_TRUE(cells.insert({static_cast<int>(q[0]), static_cast<int>(q[1]), static_cast<int>(q[2])}).second);
  }
  EXPECT_GE(test::brute_spacing(samples), 0.5 * spacing);
}

TEST(StratifiedSampling, WithoutSuppressionEveryStratumGivesOne) {
  // The corners of a square of edge 2 lie in four cells of size 1, their mean in a fifth.
  std::vector<Vec3> points{Vec3(1, 1, 0)};
  for (int i = 0; i < 40; ++i) points.emplace_back(2 * (i % 2), 2 * (i / 2 % 2), 0.001 * i);
  const SurfaceGraph graph = test::point_graph(points);
  const std::vector<Index> chosen =
      sample_stratified(graph, test::all_vertices(graph), {.spacing = 1.0}, {.seed = 0, .suppression = 0.0});
  EXPECT_EQ(chosen.size(), 5U);
}

TEST(StratifiedSampling, DrawsNearTheCentresOfStrata) {
  // A flat sheet in one cell; uniform draws would deviate by 0.25 on average.
  std::vector<Vec3> points;
  for (int i = 0; i < 2500; ++i) points.emplace_back((i % 50 + 0.5) / 50.0, (i / 50 + 0.5) / 50.0, 3.0);
  const SurfaceGraph graph = test::point_graph(points);
  double deviation = 0.0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const std::vector<Index> chosen =
        sample_stratified(graph, test::all_vertices(graph), {.spacing = 1.0}, {.seed = seed});
    ASSERT_EQ(chosen.size(), 1U);
    deviation += std::abs(graph.position[chosen[0]].x() - 0.5) / 500.0;
  }
  EXPECT_NEAR(deviation, 1.0 / 6.0, 0.02);  // of a tent over [0, 1]
}

TEST(StratifiedSampling, AnExactCountLeavesNoLargeGaps) {
  const SurfaceGraph graph = test::ellipsoid_graph(6000);
  std::vector<Index> farthest{0};
  fill_farthest(graph.position, 600, 1.0, farthest, {});
  const std::vector<Index> chosen = sample_stratified(graph, test::all_vertices(graph), {.count = 600});
  EXPECT_LT(test::brute_coverage(graph.position, test::positions_of(graph, chosen)),
            1.35 * test::brute_coverage(graph.position, test::positions_of(graph, farthest)));
}

}  // namespace
}  // namespace shapelight
