#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "shapelight/core/error.hpp"
#include "shapelight/simplify/ssim.hpp"
#include "support/determinism.hpp"
#include "support/mesh_topology.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

const testing::Shape& ball() {
  static const testing::Shape shape = testing::sphere(3, 1.0, 0.2);
  return shape;
}

std::vector<Index> every(Index step) {
  std::vector<Index> samples;
  for (Index v = 0; v < ball().positions.size(); v += step) samples.push_back(v);
  return samples;
}

SimplifiedMesh run(std::size_t target, std::span<const Index> samples, const RunContext& context = {}) {
  return simplify_ssim_paper({ball().positions, ball().triangles}, {.vertices = target}, samples, {}, context);
}

TEST(SsimPaper, KeepsTheSamplesWhereItCan) {
  const std::vector<Index> samples = every(5);
  const SimplifiedMesh result = run(samples.size(), samples);
  EXPECT_EQ(result.source_vertex.size(), samples.size()) << "the count is exact";
  std::vector<Index> common;
  std::ranges::set_intersection(result.source_vertex, samples, std::back_inserter(common));
  EXPECT_GE(common.size(), samples.size() - 4);
  EXPECT_TRUE(testing::topology(result.mesh).is_manifold);
}

TEST(SsimPaper, TheCheapestSamplesGoWhenTheTargetIsSmaller) {
  const std::vector<Index> samples = every(5);
  const SimplifiedMesh result = run(samples.size() / 2, samples);
  EXPECT_EQ(result.source_vertex.size(), samples.size() / 2);
  std::vector<Index> common;
  std::ranges::set_intersection(result.source_vertex, samples, std::back_inserter(common));
  EXPECT_GE(common.size(), samples.size() / 2 - 2);
}

TEST(SsimPaper, RejectsSamplesThatAreNoVertices) { EXPECT_THROW((void)run(50, std::vector<Index>{642}), InvalidInput); }

TEST(SsimPaper, SameForAnyNumberOfThreads) {
  testing::expect_same_for_any_number_of_threads(
      [](const RunContext& context) { return run(100, every(7), context).mesh.triangles; });
}

}  // namespace
}  // namespace shapelight
