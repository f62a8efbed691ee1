#include "shapelight/sample/poisson.hpp"

#include <gtest/gtest.h>

#include "sample/spread.hpp"
#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

std::vector<Vec3> farthest_points(const SurfaceGraph& graph, std::size_t count) {
  std::vector<Index> chosen{0};
  fill_farthest(graph.position, count, 1.0, chosen, {});
  return test::positions_of(graph, chosen);
}

TEST(PoissonSampling, SpacingIsKeptAndNoHoleIsLeft) {
  const SurfaceGraph graph = test::ellipsoid_graph(3000);
  for (const double radius : {0.03, 0.1, 0.4, 5.0}) {
    SCOPED_TRACE(radius);
    const std::vector<Vec3> samples =
        test::positions_of(graph, sample_poisson(graph, test::all_vertices(graph), {.spacing = radius}));
    EXPECT_GE(test::brute_spacing(samples), radius);
    EXPECT_LT(test::brute_coverage(graph.position, samples), radius);
  }
}

TEST(PoissonSampling, ATinySpacingTakesEverything) {
  const SurfaceGraph graph = test::ellipsoid_graph(200);
  EXPECT_EQ(sample_poisson(graph, test::all_vertices(graph), {.spacing = 1e-12}).size(), 200U);
}

TEST(PoissonSampling, AnExactCountIsAlmostAsGoodAsFarthestPoints) {
  const SurfaceGraph graph = test::ellipsoid_graph(6000);
  for (const std::size_t count : {30U, 150U, 600U}) {
    SCOPED_TRACE(count);
    const std::vector<Vec3> farthest = farthest_points(graph, count);
    const std::vector<Vec3> samples =
        test::positions_of(graph, sample_poisson(graph, test::all_vertices(graph), {.count = count}));
    EXPECT_LT(test::brute_coverage(graph.position, samples), 1.15 * test::brute_coverage(graph.position, farthest));
    EXPECT_GT(test::brute_spacing(samples), 0.9 * test::brute_spacing(farthest));
  }
}

TEST(PoissonSampling, TheSeedMatters) {
  const SurfaceGraph graph = test::ellipsoid_graph(500);
  const std::vector<Index> all = test::all_vertices(graph);
  EXPECT_NE(sample_poisson(graph, all, {.count = 50}, {.seed = 1}),
            sample_poisson(graph, all, {.count = 50}, {.seed = 2}));
}

}  // namespace
}  // namespace shapelight
