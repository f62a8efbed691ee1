#include "shapelight/spatial/batch_queries.hpp"

#include <gtest/gtest.h>

#include "shapelight/core/error.hpp"
#include "support/random_points.hpp"
#include "support/triangles.hpp"

namespace shapelight {
namespace {

using test::random_points;

// Enough queries for several chunks, the last one not full.
constexpr std::size_t kQueries = 1000;

TEST(BatchQueries, NearestRepeatsTheSingleQueryAndFillsUp) {
  const std::vector<Vec3> queries = random_points(kQueries, 2);
  const KdTree tree(random_points(300, 1));
  constexpr std::size_t k = 7;
  constexpr double kRadius = 0.15;  // some queries have seven, some fewer
  const std::vector<Neighbor> table = nearest(tree, queries, k, kRadius);
  ASSERT_EQ(table.size(), kQueries * k);
  std::size_t missing = 0;
  std::vector<Neighbor> found;
  for (std::size_t i = 0; i < kQueries; ++i) {
    tree.nearest(queries[i], k, found, kRadius * kRadius);
    for (std::size_t j = 0; j < k; ++j) {
      const Neighbor& answer = table[i * k + j];
      EXPECT_EQ(answer.index, j < found.size() ? found[j].index : kNoIndex);
      EXPECT_EQ(std::isinf(answer.distance_sq), j >= found.size());
    }
    missing += k - found.size();
  }
  EXPECT_GT(missing, 0U);
  EXPECT_LT(missing, kQueries * k);
}

TEST(BatchQueries, WithinRepeatsTheSingleQuery) {
  const std::vector<Vec3> queries = random_points(kQueries, 2);
  const KdTree tree(random_points(300, 1));
  const NeighborLists lists = within(tree, queries, 0.2, {.max_threads = 3});
  ASSERT_EQ(lists.offsets.size(), kQueries + 1);
  EXPECT_EQ(lists.offsets.back(), lists.found.size());
  std::vector<Neighbor> found;
  for (std::size_t i = 0; i < kQueries; ++i) {
    tree.within(queries[i], 0.2, found);
    ASSERT_EQ(lists.offsets[i + 1] - lists.offsets[i], found.size());
    for (std::size_t j = 0; j < found.size(); ++j) EXPECT_EQ(lists.found[lists.offsets[i] + j].index, found[j].index);
  }
}

TEST(BatchQueries, FirstHitsRepeatTheSingleQuery) {
  const TriangleTree tree(testing::random_triangles(200, 0.2, 3));
  const std::vector<Vec3> origins = random_points(kQueries, 4);
  std::vector<Vec3> directions = random_points(kQueries, 5);
  for (Vec3& direction : directions) direction -= Vec3::Constant(0.5);
  const std::vector<TriangleTree::RayHit> hits = first_hits(tree, origins, directions);
  ASSERT_EQ(hits.size(), kQueries);
  for (std::size_t i = 0; i < kQueries; ++i) {
    EXPECT_EQ(hits[i].triangle, tree.first_hit(origins[i], directions[i]).triangle);
  }
}

TEST(BatchQueries, RefuseWhatMakesNoSense) {
  const KdTree tree(random_points(10, 1));
  const std::vector<Vec3> queries = random_points(3, 2);
  EXPECT_THROW((void)nearest(tree, queries, 1, -1.0), InvalidInput);
  EXPECT_THROW((void)within(tree, queries, std::nan("")), InvalidInput);
  EXPECT_THROW((void)first_hits(TriangleTree(), queries, std::vector<Vec3>(2)), InvalidInput);
}

TEST(BatchQueries, StopWhenAsked) {
  const std::vector<Vec3> queries = random_points(kQueries, 2);
  const KdTree tree(random_points(10, 1));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW((void)nearest(tree, queries, 1, 1.0, {.stop = stop.get_token()}), Cancelled);
  EXPECT_THROW((void)within(tree, queries, 1.0, {.stop = stop.get_token()}), Cancelled);
}

}  // namespace
}  // namespace shapelight
