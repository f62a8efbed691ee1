#include "registration/match_descriptors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "core/random.hpp"
#include "support/determinism.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kBins = DescribedPoints::kBins;

/// Descriptors at random; every third point is a keypoint. Places do not matter.
DescribedPoints random_points(std::size_t count, std::uint64_t seed) {
  DescribedPoints points;
  points.spacing = 1.0;
  points.position.assign(count, Vec3::Zero());
  points.normal.assign(count, Vec3::UnitZ());
  for (std::size_t i = 0; i < count * kBins; ++i) points.descriptor.push_back(static_cast<float>(random01(seed, 0, i)));
  for (std::size_t i = 0; i < count; i += 3) points.keypoints.push_back(static_cast<Index>(i));
  return points;
}

float difference(const DescribedPoints& a, std::size_t i, const DescribedPoints& b, std::size_t j, bool turned) {
  float sum = 0.0F;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const std::size_t third = bin / (kBins / 3);
    const std::size_t mirrored = turned && third > 0 ? (2 * third + 1) * kBins / 3 - 1 - bin : bin;
    const float d = a.descriptor[i * kBins + mirrored] - b.descriptor[j * kBins + bin];
    sum += d * d;
  }
  return sum;
}

void add_by_brute_force(const DescribedPoints& from, const DescribedPoints& to, bool same_side, bool is_back,
                        std::vector<Match>& matches) {
  for (const Index k : from.keypoints) {
    std::vector<std::tuple<float, bool, Index>> all;
    for (Index j = 0; j < to.size(); ++j) {
      all.emplace_back(difference(from, k, to, j, false), false, j);
      if (!same_side) all.emplace_back(difference(from, k, to, j, true), true, j);
    }
    std::sort(all.begin(), all.end());
    for (std::size_t best = 0; best < std::min<std::size_t>(2, all.size()); ++best) {
      const auto& [value, turned, j] = all[best];
      matches.push_back(is_back ? Match{j, k, turned} : Match{k, j, turned});
    }
  }
}

TEST(MatchDescriptors, AgreesWithBruteForce) {
  const DescribedPoints source = random_points(150, 1);
  const DescribedPoints target = random_points(200, 2);
  for (const bool same_side : {true, false}) {
    std::vector<Match> expected;
    add_by_brute_force(source, target, same_side, false, expected);
    add_by_brute_force(target, source, same_side, true, expected);
    std::sort(expected.begin(), expected.end());
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    EXPECT_TRUE(match_descriptors(source, target, same_side, {}) == expected);
  }
}

TEST(MatchDescriptors, NothingToMatch) {
  const DescribedPoints none;
  const DescribedPoints one = random_points(1, 3);
  EXPECT_TRUE(match_descriptors(none, none, true, {}).empty());
  EXPECT_TRUE(match_descriptors(none, one, true, {}).empty());
  EXPECT_EQ(match_descriptors(one, one, true, {}).size(), 1U) << "both ways give the same match";
}

TEST(MatchDescriptors, SameForAnyNumberOfThreads) {
  const DescribedPoints source = random_points(600, 4);
  const DescribedPoints target = random_points(500, 5);
  testing::expect_same_for_any_number_of_threads(
      [&](const RunContext& context) { return match_descriptors(source, target, false, context).size(); });
}

}  // namespace
}  // namespace shapelight
