#include "shapelight/sample/shape_sampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/graphs.hpp"
#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

double distance_sq(const Vec3& a, const Vec3& b) {
  const double x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
  return x * x + y * y + z * z;
}

// Whether pick m is local: the share of local picks stays within one of T.
std::vector<bool> local_turns(double share, std::size_t count) {
  std::vector<bool> turns;
  std::size_t num_local = 0;
  for (std::size_t m = 0; m < count; ++m) {
    turns.push_back(static_cast<double>(num_local) < share * static_cast<double>(m + 1));
    num_local += turns.back();
  }
  return turns;
}

// The definition, in O(n count): the largest w d^2 on local turns, the largest d^2 on the others, ties by index. At first
// d is the distance to the centroid.
std::vector<Index> brute_force(const std::vector<Vec3>& points, const std::vector<double>& weights, double share,
                               std::size_t count) {
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : points) centroid += p;
  centroid /= static_cast<double>(points.size());
  std::vector<double> nearest;
  for (const Vec3& p : points) nearest.push_back(distance_sq(p, centroid));
  std::vector<Index> picks;
  const std::vector<bool> turns = local_turns(share, count);
  while (picks.size() < count) {
    std::vector<double> score = nearest;
    if (turns[picks.size()]) {
      for (std::size_t i = 0; i < points.size(); ++i) score[i] *= weights[i];
      if (*std::max_element(score.begin(), score.end()) == 0.0) score = nearest;
    }
    picks.push_back(static_cast<Index>(std::max_element(score.begin(), score.end()) - score.begin()));
    if (picks.size() == 1) nearest.assign(points.size(), HUGE_VAL);
    for (std::size_t i = 0; i < points.size(); ++i) {
      nearest[i] = std::min(nearest[i], distance_sq(points[i], points[picks.back()]));
    }
  }
  return picks;
}

std::vector<double> random_weights(std::size_t count) {
  std::vector<double> weights(count);
  for (std::size_t i = 0; i < count; ++i) weights[i] = i % 17 == 0 ? 0.0 : 0.15 + 5.0 * random01(3, 0, i);
  return weights;
}

TEST(ShapeSampling, IsTheGreedyOfItsDefinition) {
  const SurfaceGraph graph = test::ellipsoid_graph(400);
  const std::vector<double> weights = random_weights(400);
  for (const double share : {0.0, 0.3, 0.65, 1.0}) {
    EXPECT_EQ(sample_by_shape(graph, test::all_vertices(graph), weights, {.count = 400}, {.local_weight = share}),
              brute_force(graph.position, weights, share, 400))
        << "T = " << share;
  }
}

TEST(ShapeSampling, TiesGoToTheLowestIndex) {
  std::vector<Vec3> lattice;
  for (int i = 0; i < 216; ++i) lattice.emplace_back(i % 6, i / 6 % 6, i / 36);
  const SurfaceGraph graph = test::point_graph(lattice);
  const std::vector<double> equal(lattice.size(), 1.0);
  for (const double share : {0.0, 0.65, 1.0}) {
    EXPECT_EQ(sample_by_shape(graph, test::all_vertices(graph), equal, {.count = 216}, {.local_weight = share}),
              brute_force(lattice, equal, share, 216));
  }
}

TEST(ShapeSampling, TurnsOfLocalAndGlobalPicks) {
  // A dense heavy cluster far from a sparse light grid: a local pick falls into the cluster, a global one never does
  // while the grid is open.
  std::vector<Vec3> points;
  std::vector<double> weights;
  for (int i = 0; i < 64; ++i) {
    points.emplace_back(10.0 * (i % 8), 10.0 * (i / 8), 0.0);
    weights.push_back(1e-9);
  }
  for (int i = 0; i < 64; ++i) {
    points.emplace_back(1000.0 + 0.1 * (i % 8), 0.1 * (i / 8), 0.0);
    weights.push_back(1.0);
  }
  const SurfaceGraph graph = test::point_graph(points);
  const std::vector<bool> turns = local_turns(0.65, 40);
  const std::vector<Index> picks = sample_by_shape(graph, test::all_vertices(graph), weights, {.count = 40});
  std::size_t num_local = 0;
  for (std::size_t m = 0; m < picks.size(); ++m) {
    EXPECT_EQ(picks[m] >= 64, turns[m]) << "pick " << m;
    num_local += picks[m] >= 64;
    EXPECT_LE(std::abs(static_cast<double>(num_local) - 0.65 * static_cast<double>(m + 1)), 1.0);
  }
}

TEST(ShapeSampling, EveryPrefixIsTheSampleOfItsLength) {
  const SurfaceGraph graph = test::ellipsoid_graph(900);
  const std::vector<Index> all = test::all_vertices(graph);
  const std::vector<double> weights = random_weights(900);
  const std::vector<Index> whole = sample_by_shape(graph, all, weights, {.count = 900});
  for (const std::size_t count : {1u, 2u, 9u, 90u, 451u, 899u}) {
    const std::vector<Index> part = sample_by_shape(graph, all, weights, {.count = count});
    ASSERT_EQ(part.size(), count);
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin())) << count;
  }
  std::vector<Index> sorted = whole;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, all) << "a ranking of all names each vertex once";
}

TEST(ShapeSampling, SpacingStopsWhenEverythingIsNear) {
  const SurfaceGraph graph = test::ellipsoid_graph(600);
  const std::vector<Index> all = test::all_vertices(graph);
  const std::vector<double> weights = random_weights(600);
  for (const double spacing : {0.5, 0.2, 0.05}) {
    const std::vector<Index> picks = sample_by_shape(graph, all, weights, {.spacing = spacing});
    EXPECT_LE(test::brute_coverage(graph.position, test::positions_of(graph, picks)), spacing);
    const std::vector<Index> fewer(picks.begin(), picks.end() - 1);
    EXPECT_GT(test::brute_coverage(graph.position, test::positions_of(graph, fewer)), spacing) << "stopped late";
    const std::vector<Index> ranking = sample_by_shape(graph, all, weights, {.count = picks.size()});
    EXPECT_EQ(picks, ranking) << "a spacing cuts the same ranking";
  }
  EXPECT_EQ(sample_by_shape(graph, all, weights, {.spacing = 100.0}).size(), 1u);
}

TEST(ShapeSampling, ChoosesAmongCandidatesOnly) {
  const SurfaceGraph graph = test::ellipsoid_graph(300);
  const std::vector<Index> odd = {1, 3, 8, 77, 150, 299};
  std::vector<Index> picks = sample_by_shape(graph, odd, random_weights(300), {.count = odd.size()});
  std::sort(picks.begin(), picks.end());
  EXPECT_EQ(picks, odd);
}

TEST(ShapeSampling, CoincidentPointsAreEachChosenOnce) {
  const SurfaceGraph graph = test::point_graph(std::vector<Vec3>(12, Vec3(1, 2, 3)));
  const std::vector<Index> all = test::all_vertices(graph);
  EXPECT_EQ(sample_by_shape(graph, all, std::vector<double>(12, 1.0), {.count = 1}).size(), 1u);
  std::vector<Index> picks = sample_by_shape(graph, all, std::vector<double>(12, 1.0), {.spacing = 1.0});
  EXPECT_EQ(picks.size(), 1u);
}

TEST(ShapeSampling, FarthestStartsFarFromTheCentroid) {
  const SurfaceGraph graph = test::point_graph({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {10, 0, 0}});
  EXPECT_EQ(sample_farthest(graph, test::all_vertices(graph), {.count = 4}), (std::vector<Index>{3, 0, 2, 1}));
}

TEST(ShapeSampling, RefusesWhatDoesNotFit) {
  const SurfaceGraph graph = test::ellipsoid_graph(20);
  const std::vector<Index> all = test::all_vertices(graph);
  std::vector<double> weights(20, 1.0);
  EXPECT_THROW((void)sample_by_shape(graph, all, std::vector<double>(19, 1.0), {.count = 5}), InvalidInput);
  EXPECT_THROW((void)sample_by_shape(graph, all, weights, {.count = 21}), InvalidInput);
  EXPECT_THROW((void)sample_by_shape(graph, all, weights, {}), InvalidInput);
  for (const std::vector<Index>& bad : {std::vector<Index>{0, 20}, std::vector<Index>{3, 2}}) {
    EXPECT_THROW((void)sample_by_shape(graph, bad, weights, {.count = 1}), InvalidInput);
    EXPECT_THROW((void)sample_farthest(graph, bad, {.count = 1}), InvalidInput);
  }
  EXPECT_THROW((void)sample_by_shape(graph, all, weights, {.count = 5}, {.local_weight = 1.1}), InvalidInput);
  for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
    weights[7] = bad;
    EXPECT_THROW((void)sample_by_shape(graph, all, weights, {.count = 5}), InvalidInput) << bad;
  }
}

TEST(ShapeSampling, AStopRequestEndsIt) {
  const SurfaceGraph graph = test::ellipsoid_graph(600);
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  context.progress = [&](double fraction, std::string_view) {
    if (fraction > 0.3) stop.request_stop();
  };
  EXPECT_THROW((void)sample_farthest(graph, test::all_vertices(graph), {.count = 600}, context), Cancelled);
}

// A plane with one curved vertex in the middle.
struct DensityCase {
  SurfaceGraph graph = graph_of_mesh(plane(21, 1.0));
  Index middle = 10 * 21 + 10;
  std::vector<double> curvedness = std::vector<double>(graph.size(), 0.0);
  std::vector<double> variation = std::vector<double>(graph.size(), 0.0);
  std::vector<double> density(const ShapeFields& more = {}) const {
    ShapeFields fields = more;
    fields.curvedness = curvedness;
    fields.surface_variation = variation;
    return sampling_density(graph, fields);
  }
};

TEST(SamplingDensity, FlatSurfaceHasTheFloorEverywhere) {
  for (const double w : DensityCase().density()) EXPECT_EQ(w, 0.15);
}

TEST(SamplingDensity, EqualFieldsGiveOne) {
  DensityCase c;
  c.curvedness.assign(c.graph.size(), 3.0);
  c.variation.assign(c.graph.size(), 0.1);
  for (const double w : c.density()) EXPECT_NEAR(w, 1.0, 1e-12);
}

TEST(SamplingDensity, IsCappedAndFloored) {
  DensityCase c;
  for (Index i = 0; i < c.graph.size(); ++i) c.variation[i] = 0.01;
  c.curvedness[c.middle] = 1e6;
  c.variation[c.middle] = 0.3;
  const std::vector<double> density = c.density();
  EXPECT_EQ(*std::max_element(density.begin(), density.end()), density[c.middle]);
  // The cap is six means; the last division raises it by what capping took from the mean.
  EXPECT_LT(density[c.middle], 60.0);
  EXPECT_GE(*std::min_element(density.begin(), density.end()), 0.15);
  EXPECT_GT(density[c.middle + 1], density[0]) << "the curved term spreads over the ring";
}

TEST(SamplingDensity, TermsHaveTheSharesOfTheFormula) {
  DensityCase c;
  // Half of the surface curved at 1, so its capped mean share is 2; the other half flat.
  double curved_area = 0.0;
  std::vector<std::uint8_t> curved(c.graph.size(), 0);
  for (Index i = 0; i < c.graph.size(); ++i) {
    if (c.graph.position[i].x() < 0.0) {
      c.variation[i] = 0.2;
      curved[i] = 1;
      curved_area += c.graph.area[i];
    }
  }
  const double scaled = c.graph.total_area / curved_area;
  const std::vector<double> density = c.density();
  for (Index i = 0; i < c.graph.size(); ++i) {
    EXPECT_NEAR(density[i], curved[i] ? 0.7 * scaled : 0.15, 1e-9);
  }
}

TEST(SamplingDensity, ShapeIndexAndReflectanceModulate) {
  DensityCase c;
  c.curvedness.assign(c.graph.size(), 1.0);
  std::vector<double> shape_index(c.graph.size(), 0.0), reflectance(c.graph.size(), 0.0);
  for (Index i = 0; i < c.graph.size(); ++i) {
    if (c.graph.position[i].x() < 0.0) shape_index[i] = -1.0, reflectance[i] = 0.5;
  }
  const std::vector<double> density =
      c.density({.curvedness = {}, .surface_variation = {}, .shape_index = shape_index, .reflectance = reflectance});
  const Index inside = 10 * 21 + 2, outside = 10 * 21 + 18;
  ASSERT_LT(c.graph.position[inside].x(), -2.0);
  ASSERT_GT(c.graph.position[outside].x(), 2.0);
  // (0.5 + 1)(1 + 2) against 0.5 x 1.
  EXPECT_NEAR(density[inside] / std::max(0.15, density[inside] / 9.0), density[inside] / density[outside], 1e-9);
}

TEST(SamplingDensity, StraysAndIsolatedVerticesHaveNone) {
  DensityCase c;
  c.graph.outlier[c.middle] = 1;
  EXPECT_EQ(c.density()[c.middle], 0.0);
  const SurfaceGraph alone = isolated(3);
  const std::vector<double> zero(3, 0.0);
  EXPECT_EQ(sampling_density(alone, {.curvedness = zero, .surface_variation = zero, .shape_index = {}, .reflectance = {}}),
            zero);
}

TEST(SamplingDensity, ValuesThatAreNotFiniteCountAsZero) {
  DensityCase clean, dirty;
  for (Index i = 0; i < clean.graph.size(); ++i) {
    clean.curvedness[i] = dirty.curvedness[i] = 0.1 * (i % 7);
    clean.variation[i] = dirty.variation[i] = 0.01 * (i % 5);
  }
  clean.curvedness[5] = clean.variation[9] = clean.curvedness[30] = 0.0;
  dirty.curvedness[5] = std::nan("");
  dirty.variation[9] = HUGE_VAL;
  dirty.curvedness[30] = -HUGE_VAL;
  EXPECT_EQ(dirty.density(), clean.density());
}

TEST(SamplingDensity, NoiseFloorIsSubtractedWhenNoisy) {
  DensityCase c;
  for (Index i = 0; i < c.graph.size(); ++i) c.variation[i] = 0.05;
  c.variation[c.middle] = 0.06;
  const std::vector<double> density =
      c.density({.curvedness = {}, .surface_variation = {}, .shape_index = {}, .reflectance = {}, .noisy = true});
  EXPECT_EQ(density[0], 0.15);
  EXPECT_GT(density[c.middle], 4.0);
}

TEST(SamplingDensity, RefusesFieldsOfAnotherLength) {
  const DensityCase c;
  const std::vector<double> good(c.graph.size(), 0.0), bad(c.graph.size() - 1, 0.0);
  const auto call = [&](std::span<const double> a, std::span<const double> b, std::span<const double> s,
                        std::span<const double> r) {
    return sampling_density(c.graph, {.curvedness = a, .surface_variation = b, .shape_index = s, .reflectance = r});
  };
  EXPECT_NO_THROW((void)call(good, good, {}, {}));
  EXPECT_THROW((void)call(bad, good, {}, {}), InvalidInput);
  EXPECT_THROW((void)call({}, good, {}, {}), InvalidInput);
  EXPECT_THROW((void)call(good, bad, {}, {}), InvalidInput);
  EXPECT_THROW((void)call(good, good, bad, {}), InvalidInput);
  EXPECT_THROW((void)call(good, good, good, bad), InvalidInput);
}

TEST(SamplingDensity, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(sphere(5, 1.0, 0.3));
  std::vector<double> a(graph.size()), b(graph.size());
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = random01(1, 0, i), b[i] = random01(1, 1, i);
  expect_same_for_any_number_of_threads([&](const RunContext& context) {
    return sampling_density(graph, {.curvedness = a, .surface_variation = b, .shape_index = {}, .reflectance = {}},
                            context);
  });
}

}  // namespace
}  // namespace shapelight
