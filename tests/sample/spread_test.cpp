#include "sample/spread.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "support/point_graphs.hpp"
#include "support/random_points.hpp"

namespace shapelight {
namespace {

TEST(CellGrid, SeesEveryPointWithinACellSize) {
  const std::vector<Vec3> points = test::random_points(400, 3);
  for (const double cell : {0.01, 0.1, 0.3, 2.0}) {
    const CellGrid grid(points, cell, {});
    for (std::size_t slot = 0; slot < grid.size(); ++slot) {
      std::set<std::uint32_t> seen;
      grid.for_each_near(slot, [&](std::uint32_t other) { EXPECT_TRUE(seen.insert(other).second); });
      for (std::uint32_t other = 0; other < grid.size(); ++other) {
        const bool is_near = (grid.point(slot) - grid.point(other)).norm() <= cell;
        EXPECT_TRUE(!is_near || seen.count(other) == 1) << cell;
      }
    }
  }
}

TEST(CellGrid, FindsACellSizeForACount) {
  std::vector<Vec3> line;
  for (int i = 0; i < 20000; ++i) line.emplace_back(0.001 * i, 0.0005 * i, random01(1, 0, i));
  const std::vector<Vec3> surface = test::ellipsoid_graph(20000).position;
  for (const auto& points : {surface, line, test::random_points(20000, 8)}) {
    for (const std::size_t count : {1U, 2U, 10U, 300U, 5000U, 20000U}) {
      const std::size_t cells = CellGrid(points, find_cell_size(points, count, {}), {}).num_cells();
      EXPECT_LE(cells, count);
      EXPECT_GE(static_cast<double>(cells), (count < 20 ? 0.4 : 0.95) * static_cast<double>(count));
    }
  }
}

/// Greedy farthest points by definition; distances only, as ties are free.
std::vector<double> brute_fill(const std::vector<Vec3>& points, std::vector<Index> chosen, std::size_t count) {
  std::vector<double> gaps;
  while (chosen.size() < count) {
    double widest = -1.0;
    Index farthest = 0;
    for (Index i = 0; i < points.size(); ++i) {
      double nearest = HUGE_VAL;
      for (const Index c : chosen) nearest = std::min(nearest, (points[i] - points[c]).norm());
      if (nearest > widest && std::find(chosen.begin(), chosen.end(), i) == chosen.end()) {
        widest = nearest;
        farthest = i;
      }
    }
    gaps.push_back(widest);
    chosen.push_back(farthest);
  }
  return gaps;
}

TEST(FillFarthest, EqualsBruteForceForAnyReach) {
  const std::vector<Vec3> points = test::random_points(150, 5);
  const std::vector<double> expected = brute_fill(points, {4, 17}, 150);
  for (const double reach : {1e-9, 0.05, 0.3, 10.0}) {
    std::vector<Index> chosen{4, 17};
    fill_farthest(points, 150, reach, chosen, {});
    ASSERT_EQ(chosen.size(), 150U);
    for (std::size_t k = 2; k < chosen.size(); ++k) {
      double gap = HUGE_VAL;
      for (std::size_t j = 0; j < k; ++j) gap = std::min(gap, (points[chosen[k]] - points[chosen[j]]).norm());
      EXPECT_EQ(gap, expected[k - 2]) << "reach " << reach << ", pick " << k;
    }
  }
}

TEST(FillFarthest, TakesPointsAtTheSamePlaceLast) {
  std::vector<Vec3> points(10, Vec3::Zero());
  points[7] = Vec3::UnitX();
  std::vector<Index> chosen{2};
  fill_farthest(points, 10, 1.0, chosen, {});
  EXPECT_EQ(chosen[1], 7U);
  EXPECT_EQ(std::set<Index>(chosen.begin(), chosen.end()).size(), 10U);
}

TEST(FillFarthest, TiesDoNotFollowTheOrderOfThePoints) {
  // A square lattice with every point equally far from a chosen one once half are taken.
  std::vector<Vec3> points;
  std::vector<Index> chosen;
  for (Index i = 0; i < 1600; ++i) {
    points.emplace_back(i % 40, i / 40, 0.0);
    if ((i % 40 + i / 40) % 2 == 0) chosen.push_back(i);
  }
  fill_farthest(points, 1000, 1.0, chosen, {});
  const auto front = std::count_if(chosen.begin() + 800, chosen.end(), [](Index i) { return i / 40 < 20; });
  const auto left = std::count_if(chosen.begin() + 800, chosen.end(), [](Index i) { return i % 40 < 20; });
  EXPECT_NEAR(static_cast<double>(front), 100.0, 30.0);
  EXPECT_NEAR(static_cast<double>(left), 100.0, 30.0);
}

TEST(ThrowDarts, ObeysOrderRadiusAndLimit) {
  const std::vector<Vec3> points = test::random_points(500, 9);
  const CellGrid grid(points, 0.2, {});
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.rbegin(), order.rend(), 0U);
  std::vector<std::uint32_t> expected;
  for (const std::uint32_t slot : order) {
    const bool is_free = std::all_of(expected.begin(), expected.end(), [&](std::uint32_t other) {
      return (grid.point(slot) - grid.point(other)).norm() >= 0.15;
    });
    if (is_free) expected.push_back(slot);
  }
  EXPECT_EQ(throw_darts(grid, order, 0.15, 500, {}), expected);
  expected.resize(5);
  EXPECT_EQ(throw_darts(grid, order, 0.15, 5, {}), expected);
}

}  // namespace
}  // namespace shapelight
