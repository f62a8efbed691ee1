#include "shapelight/sample/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

TEST(RandomSampling, IsARanking) {
  const SurfaceGraph graph = test::ellipsoid_graph(500);
  const std::vector<Index> all = test::all_vertices(graph);
  const std::vector<Index> large = sample_random(graph, all, {.count = 400});
  const std::vector<Index> small = sample_random(graph, all, {.count = 50});
  EXPECT_TRUE(std::equal(small.begin(), small.end(), large.begin()));
}

TEST(RandomSampling, DrawsEveryVertexEquallyOften) {
  const SurfaceGraph graph = test::ellipsoid_graph(100);
  const std::vector<Index> all = test::all_vertices(graph);
  std::vector<int> drawn(100, 0);
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    for (const Index v : sample_random(graph, all, {.count = 20}, {.seed = seed})) ++drawn[v];
  }
  // Expected 400, standard deviation 18.
  EXPECT_GT(*std::min_element(drawn.begin(), drawn.end()), 320);
  EXPECT_LT(*std::max_element(drawn.begin(), drawn.end()), 480);
}

TEST(RandomSampling, AreaWeightsDrawInProportion) {
  std::vector<double> areas(1000, 1.0);
  std::fill(areas.begin(), areas.begin() + 500, 3.0);
  const SurfaceGraph graph = test::point_graph(test::ellipsoid_graph(1000).position, {}, areas);
  const std::vector<Index> all = test::all_vertices(graph);
  std::size_t heavy = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    for (const Index v : sample_random(graph, all, {.count = 20}, {.seed = seed, .area_weighted = true}))
      heavy += v < 500;
  }
  EXPECT_NEAR(static_cast<double>(heavy) / 4000.0, 0.75, 0.03);
}

TEST(RandomSampling, VerticesWithoutAreaComeLast) {
  std::vector<double> areas(50, 1.0);
  std::fill(areas.begin(), areas.begin() + 10, 0.0);
  const SurfaceGraph graph = test::point_graph(test::ellipsoid_graph(50).position, {}, areas);
  const std::vector<Index> chosen =
      sample_random(graph, test::all_vertices(graph), {.count = 50}, {.seed = 3, .area_weighted = true});
  for (std::size_t k = 0; k < 50; ++k) EXPECT_EQ(chosen[k] < 10, k >= 40) << k;
}

}  // namespace
}  // namespace shapelight
