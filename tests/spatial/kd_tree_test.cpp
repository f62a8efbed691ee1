#include "shapelight/spatial/kd_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random_points.hpp"

namespace shapelight {
namespace {

std::vector<Neighbor> brute_force(std::span<const Vec3> points, const Vec3& query) {
  std::vector<Neighbor> all(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 d = points[i] - query;
    all[i] = {d.x() * d.x() + d.y() * d.y() + d.z() * d.z(), static_cast<Index>(i)};
  }
  std::sort(all.begin(), all.end());
  return all;
}

// Random points, half of them on a coarse lattice so that ties and duplicates are common.
std::vector<Vec3> points_with_ties(std::size_t count) {
  std::vector<Vec3> points = test::random_points(count, 7);
  for (std::size_t i = 0; i < count; i += 2) points[i] = (points[i] * 4.0).array().floor().matrix() / 4.0;
  return points;
}

TEST(KdTree, NearestAgreesWithBruteForceTiesIncluded) {
  const std::vector<Vec3> points = points_with_ties(700);
  const KdTree tree(points);
  std::vector<Neighbor> found;
  for (const Vec3& query : points_with_ties(60)) {
    const std::vector<Neighbor> expected = brute_force(points, query);
    for (const std::size_t k : {std::size_t{1}, std::size_t{5}, std::size_t{40}}) {
      tree.nearest(query, k, found);
      ASSERT_EQ(found.size(), k);
      for (std::size_t i = 0; i < k; ++i) {
        EXPECT_EQ(found[i].index, expected[i].index);
        EXPECT_EQ(found[i].distance_sq, expected[i].distance_sq);
      }
    }
    EXPECT_EQ(tree.nearest(query).index, expected.front().index);
  }
}

TEST(KdTree, NearestWithinALimitAreTheFirstOfAll) {
  const std::vector<Vec3> points = points_with_ties(700);
  const KdTree tree(points);
  std::vector<Neighbor> found;
  for (const Vec3& query : points_with_ties(60)) {
    const std::vector<Neighbor> expected = brute_force(points, query);
    for (const double limit_sq : {0.0, expected[3].distance_sq, 1.0}) {  // a point at the limit counts
      const auto count = static_cast<std::size_t>(std::count_if(
          expected.begin(), expected.end(), [&](const Neighbor& n) { return n.distance_sq <= limit_sq; }));
      tree.nearest(query, 5, found, limit_sq);
      ASSERT_EQ(found.size(), std::min<std::size_t>(5, count));
      for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].index, expected[i].index);
    }
  }
}

TEST(KdTree, WithinAgreesWithBruteForce) {
  const std::vector<Vec3> points = points_with_ties(500);
  const KdTree tree(points);
  std::vector<Neighbor> found;
  for (const double radius : {0.0, 0.1, 0.25, 2.0}) {
    tree.within(points[10], radius, found);
    std::vector<Neighbor> expected = brute_force(points, points[10]);
    std::erase_if(expected, [&](const Neighbor& n) { return n.distance_sq > radius * radius; });
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].index, expected[i].index);
  }
}

TEST(KdTree, AllNearestIsOneQueryPerPointWithoutItself) {
  const std::vector<Vec3> points = points_with_ties(3000);
  const KdTree tree(points);
  const std::size_t k = 9;
  for (const int threads : {1, 2, 3, 8}) {
    const std::vector<Index> table = tree.all_nearest(k, {.max_threads = threads});
    ASSERT_EQ(table.size(), points.size() * k);
    for (std::size_t i = 0; i < points.size(); i += 37) {
      // Of the k + 1 best, itself goes; among more duplicates than k it may not have been one of them.
      std::vector<Neighbor> expected = brute_force(points, points[i]);
      expected.resize(k + 1);
      std::erase_if(expected, [&](const Neighbor& n) { return n.index == i; });
      for (std::size_t j = 0; j < k; ++j) EXPECT_EQ(table[i * k + j], expected[j].index) << i << " " << j;
    }
  }
}

TEST(KdTree, FewPoints) {
  EXPECT_EQ(KdTree({}).nearest(Vec3::Zero()).index, kNoIndex);
  const std::vector<Vec3> two = {Vec3(0, 0, 0), Vec3(1, 0, 0)};
  const KdTree tree(two);
  std::vector<Neighbor> found;
  tree.nearest(Vec3(0.9, 0, 0), 5, found);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].index, 1U);
  EXPECT_EQ(tree.all_nearest(3), (std::vector<Index>{1, kNoIndex, kNoIndex, 0, kNoIndex, kNoIndex}));
}

}  // namespace
}  // namespace shapelight
