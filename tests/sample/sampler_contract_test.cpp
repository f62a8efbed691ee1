#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "shapelight/core/error.hpp"
#include "shapelight/sample/covariance.hpp"
#include "shapelight/sample/normal_space.hpp"
#include "shapelight/sample/poisson.hpp"
#include "shapelight/sample/random.hpp"
#include "shapelight/sample/stratified.hpp"
#include "shapelight/sample/voxel.hpp"
#include "support/point_graphs.hpp"

// What every sampler promises, whatever its method.
namespace shapelight {
namespace {

using Sampler = std::function<std::vector<Index>(const SurfaceGraph&, std::span<const Index>, const SamplingTarget&,
                                                 const RunContext&)>;
struct Method {
  const char* name;
  Sampler sample;
  bool takes_spacing;
};

void PrintTo(const Method& method, std::ostream* out) { *out << method.name; }

template <class Options>
Sampler with_defaults(std::vector<Index> (*sampler)(const SurfaceGraph&, std::span<const Index>, const SamplingTarget&,
                                                    const Options&, const RunContext&)) {
  return [sampler](const SurfaceGraph& graph, std::span<const Index> candidates, const SamplingTarget& target,
                   const RunContext& context) { return sampler(graph, candidates, target, Options{}, context); };
}

class SamplerContract : public testing::TestWithParam<Method> {
 protected:
  static std::vector<Index> sample(const SurfaceGraph& graph, std::span<const Index> candidates, std::size_t count,
                                   const RunContext& context = {}) {
    return GetParam().sample(graph, candidates, {.count = count}, context);
  }
};

void expect_unique_candidates(std::vector<Index> chosen, const std::vector<Index>& candidates) {
  std::sort(chosen.begin(), chosen.end());
  EXPECT_TRUE(std::adjacent_find(chosen.begin(), chosen.end()) == chosen.end()) << "a vertex was chosen twice";
  EXPECT_TRUE(std::includes(candidates.begin(), candidates.end(), chosen.begin(), chosen.end()));
}

TEST_P(SamplerContract, MeetsEveryCount) {
  const SurfaceGraph graph = test::ellipsoid_graph(1500);
  std::vector<Index> candidates;
  for (Index v = 0; v < graph.size(); v += v % 3 + 1) candidates.push_back(v);
  const std::size_t n = candidates.size();
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{7}, n / 50, n / 10, n / 4,
                                  n / 2, 9 * n / 10, n - 1, n}) {
    SCOPED_TRACE(count);
    const std::vector<Index> chosen = sample(graph, candidates, count);
    EXPECT_EQ(chosen.size(), count);
    expect_unique_candidates(chosen, candidates);
  }
}

TEST_P(SamplerContract, MeetsCountsOnAwkwardShapes) {
  std::vector<Vec3> line, lattice, clusters;
  for (int i = 0; i < 200; ++i) {
    line.emplace_back(i, 0.0, 0.0);
    lattice.emplace_back(i % 20, i / 20, 0.0);
    // Two clusters a thousand million times smaller than their distance.
    clusters.emplace_back((i % 2) + 1e-9 * (i / 2 % 10), 1e-9 * (i / 20), 0.0);
  }
  for (const auto& points : {line, lattice, clusters, std::vector<Vec3>(1, Vec3::Zero())}) {
    const SurfaceGraph graph = test::point_graph(points);
    const std::vector<Index> all = test::all_vertices(graph);
    for (std::size_t count = 1; count <= all.size(); count += 1 + count / 3) {
      SCOPED_TRACE(count);
      const std::vector<Index> chosen = sample(graph, all, count);
      EXPECT_EQ(chosen.size(), count);
      expect_unique_candidates(chosen, all);
    }
  }
}

TEST_P(SamplerContract, RefusesCountsThatCannotBe) {
  const SurfaceGraph graph = test::ellipsoid_graph(10);
  const std::vector<Index> all = test::all_vertices(graph);
  EXPECT_THROW(sample(graph, all, 0), InvalidInput);
  EXPECT_THROW(sample(graph, all, 11), InvalidInput);
  EXPECT_THROW(sample(graph, {}, 1), InvalidInput);
}

TEST_P(SamplerContract, RefusesBadCandidates) {
  const SurfaceGraph graph = test::ellipsoid_graph(10);
  EXPECT_THROW(sample(graph, std::vector<Index>{1, 1, 2}, 2), InvalidInput);
  EXPECT_THROW(sample(graph, std::vector<Index>{2, 1}, 1), InvalidInput);
  EXPECT_THROW(sample(graph, std::vector<Index>{1, 10}, 1), InvalidInput);
}

TEST_P(SamplerContract, RefusesSpacingByNameOrTakesIt) {
  const SurfaceGraph graph = test::ellipsoid_graph(300);
  const std::vector<Index> all = test::all_vertices(graph);
  const SamplingTarget target{.spacing = 0.3};
  if (GetParam().takes_spacing) {
    const std::vector<Index> chosen = GetParam().sample(graph, all, target, {});
    EXPECT_GT(chosen.size(), 5U);
    EXPECT_LT(chosen.size(), 200U);
    expect_unique_candidates(chosen, all);
    return;
  }
  try {
    (void)GetParam().sample(graph, all, target, {});
    FAIL() << "took a spacing";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().name), std::string::npos) << error.what();
  }
}

TEST_P(SamplerContract, DoesNotDependOnThreads) {
  const SurfaceGraph graph = test::ellipsoid_graph(12000);
  const std::vector<Index> all = test::all_vertices(graph);
  const std::vector<Index> expected = sample(graph, all, 1000, {.max_threads = 1});
  for (const int threads : {2, 3, 8}) {
    EXPECT_EQ(sample(graph, all, 1000, {.max_threads = threads}), expected) << threads << " threads";
  }
}

TEST_P(SamplerContract, DoesNotDependOnUnits) {
  SurfaceGraph graph = test::ellipsoid_graph(3000);
  const std::vector<Index> all = test::all_vertices(graph);
  const std::vector<Index> expected = sample(graph, all, 300);
  for (Vec3& p : graph.position) p *= 1000.0;
  for (double& area : graph.area) area *= 1e6;
  EXPECT_EQ(sample(graph, all, 300), expected);
}

TEST_P(SamplerContract, StopsWhenAsked) {
  const SurfaceGraph graph = test::ellipsoid_graph(12000);
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  EXPECT_THROW(sample(graph, test::all_vertices(graph), 1000, context), Cancelled);
}

TEST_P(SamplerContract, ProgressRisesToOne) {
  const SurfaceGraph graph = test::ellipsoid_graph(3000);
  std::vector<double> seen;
  RunContext context;
  context.progress = [&](double fraction, std::string_view) { seen.push_back(fraction); };
  (void)sample(graph, test::all_vertices(graph), 300, context);
  ASSERT_FALSE(seen.empty());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Methods, SamplerContract,
                         testing::Values(Method{"random", with_defaults(sample_random), false},
                                         Method{"voxel", with_defaults(sample_voxel), true},
                                         Method{"stratified", with_defaults(sample_stratified), true},
                                         Method{"poisson", with_defaults(sample_poisson), true},
                                         Method{"normal", with_defaults(sample_normal_space), false},
                                         Method{"covariance", with_defaults(sample_covariance), false}),
                         [](const auto& method) { return std::string(method.param.name); });

TEST(SamplingTarget, IsExactlyOneOfCountAndSpacing) {
  EXPECT_NO_THROW(validate(SamplingTarget{.count = 3}, 3));
  EXPECT_NO_THROW(validate(SamplingTarget{.spacing = 0.5}, 3));
  EXPECT_THROW(validate(SamplingTarget{}, 3), InvalidInput);
  EXPECT_THROW(validate(SamplingTarget{.count = 1, .spacing = 0.5}, 3), InvalidInput);
  EXPECT_THROW(validate(SamplingTarget{.count = 4}, 3), InvalidInput);
  EXPECT_THROW(validate(SamplingTarget{.spacing = -1.0}, 3), InvalidInput);
  EXPECT_THROW(validate(SamplingTarget{.spacing = std::nan("")}, 3), InvalidInput);
  EXPECT_THROW(validate(SamplingTarget{.spacing = HUGE_VAL}, 3), InvalidInput);
}

}  // namespace
}  // namespace shapelight
