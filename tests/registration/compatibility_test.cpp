#include "registration/compatibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "support/determinism.hpp"

namespace shapelight {
namespace {

Vec3 random_place(std::uint64_t stream, std::uint64_t id) {
  return Vec3(random01(5, stream, id), random01(5, stream + 1, id), random01(5, stream + 2, id));
}

std::vector<PlacePair> random_pairs(std::size_t count) {
  std::vector<PlacePair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 place = random_place(0, i);
    pairs.push_back(
        {place, place + 0.05 * random_place(3, i), random_place(6, i).normalized(), random_place(9, i).normalized()});
  }
  return pairs;
}

TEST(Compatibility, AgreesWithTheDefinition) {
  const double tolerance = 0.02;
  const std::vector<PlacePair> pairs = random_pairs(150);
  const CompatibilityGraph graph(pairs, tolerance, {});
  std::vector<std::vector<bool>> expected(pairs.size(), std::vector<bool>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = 0; j < pairs.size(); ++j) {
      const PlacePair &a = pairs[i], &b = pairs[j];
      const double p = (a.source - b.source).norm(), q = (a.target - b.target).norm();
      const double turn = a.source_normal.dot(b.source_normal) - a.target_normal.dot(b.target_normal);
      expected[i][j] = std::abs(p - q) < tolerance && std::min(p, q) > 2.0 * tolerance && std::abs(turn) < 0.35;
    }
  }
  std::size_t compatible = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    std::vector<bool> found(pairs.size());
    graph.for_each_compatible(i, [&](std::size_t j) { found[j] = true; });
    EXPECT_EQ(found, expected[i]) << "row " << i;
    compatible += static_cast<std::size_t>(graph.degree(i));
    int common = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) common += expected[i][k] && expected[0][k];
    EXPECT_EQ(graph.common(i, 0), common);
  }
  EXPECT_GT(compatible, 500U) << "else the test says nothing";
}

TEST(Compatibility, NoPairs) { EXPECT_EQ(CompatibilityGraph({}, 1.0, {}).size(), 0U); }

TEST(Compatibility, SameForAnyNumberOfThreads) {
  const std::vector<PlacePair> pairs = random_pairs(500);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const CompatibilityGraph graph(pairs, 0.02, context);
    std::vector<int> degrees;
    for (std::size_t i = 0; i < pairs.size(); ++i) degrees.push_back(graph.degree(i));
    return degrees;
  });
}

}  // namespace
}  // namespace shapelight
