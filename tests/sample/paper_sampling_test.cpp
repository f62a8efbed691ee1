#include "shapelight/sample/paper_sampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "shapelight/core/error.hpp"
#include "support/point_graphs.hpp"

namespace shapelight {
namespace {

struct Fields {
  std::vector<double> shape_index;
  std::vector<std::uint32_t> segment;
};

// Random shape indices; four segments whose sizes are in the ratio 1 : 2 : 3 : 4.
Fields random_fields(std::size_t count) {
  Fields fields;
  for (std::size_t i = 0; i < count; ++i) {
    fields.shape_index.push_back(2.0 * random01(4, 0, i) - 1.0);
    const std::size_t slot = i % 10;
    fields.segment.push_back(slot < 1 ? 0u : slot < 3 ? 1u : slot < 6 ? 2u : 3u);
  }
  return fields;
}

std::vector<Index> run(const SurfaceGraph& graph, const Fields& fields, std::size_t count, double share,
                       double voxel_size = 0.0) {
  return sample_paper(graph, test::all_vertices(graph), fields.shape_index, fields.segment, {.count = count},
                      {.local_weight = share, .voxel_size = voxel_size});
}

void expect_exact(const std::vector<Index>& picks, std::size_t count) {
  EXPECT_EQ(picks.size(), count);
  EXPECT_EQ(std::set<Index>(picks.begin(), picks.end()).size(), count) << "a point was chosen twice";
}

TEST(PaperSampling, MeetsEveryCount) {
  const SurfaceGraph graph = test::ellipsoid_graph(700);
  const Fields fields = random_fields(700);
  for (const double share : {0.0, 0.3, 0.65, 1.0}) {
    for (const std::size_t count : {1u, 2u, 3u, 7u, 10u, 35u, 70u, 175u, 350u, 699u, 700u}) {
      SCOPED_TRACE(std::to_string(share) + " " + std::to_string(count));
      expect_exact(run(graph, fields, count, share), count);
    }
  }
}

TEST(PaperSampling, LocalOnesAreTheLargestOfTheirSegment) {
  const SurfaceGraph graph = test::ellipsoid_graph(1000);
  const Fields fields = random_fields(1000);
  const std::vector<Index> picks = run(graph, fields, 200, 0.65);
  const std::set<Index> local(picks.begin(), picks.begin() + 130);
  std::map<std::uint32_t, std::size_t> quota;
  for (const Index v : local) ++quota[fields.segment[v]];
  EXPECT_EQ(quota, (std::map<std::uint32_t, std::size_t>{{0, 13}, {1, 26}, {2, 39}, {3, 52}}));
  std::map<std::uint32_t, double> weakest;
  for (const Index v : local) {
    const auto [at, fresh] = weakest.try_emplace(fields.segment[v], 2.0);
    at->second = std::min(at->second, std::abs(fields.shape_index[v]));
  }
  for (Index v = 0; v < graph.size(); ++v) {
    if (!local.contains(v)) {
      EXPECT_LE(std::abs(fields.shape_index[v]), weakest[fields.segment[v]]);
    }
  }
}

TEST(PaperSampling, EqualShapeIndicesGoByIndex) {
  const SurfaceGraph graph = test::ellipsoid_graph(50);
  const Fields fields{std::vector<double>(50, 0.5), std::vector<std::uint32_t>(50, 7)};
  std::vector<Index> picks = run(graph, fields, 5, 1.0);
  EXPECT_EQ(picks, (std::vector<Index>{0, 1, 2, 3, 4}));
}

TEST(PaperSampling, QuotasGoByTheLargestRemainder) {
  const SurfaceGraph graph = test::ellipsoid_graph(10);
  const Fields fields{std::vector<double>(10, 0.5), {0, 0, 0, 0, 0, 0, 1, 1, 1, 2}};
  const std::vector<Index> picks = run(graph, fields, 3, 1.0);  // exact shares: 1.8, 0.9, 0.3
  std::map<std::uint32_t, int> quota;
  for (const Index v : picks) ++quota[fields.segment[v]];
  EXPECT_EQ(quota, (std::map<std::uint32_t, int>{{0, 2}, {1, 1}}));
}

// Two voxels of equal size; one has 32 different shape indices (H = 5), one has a single one (H = 0).
TEST(PaperSampling, VariedVoxelsGetMoreGlobalPoints) {
  std::vector<Vec3> points;
  Fields fields;
  for (int i = 0; i < 64; ++i) {
    const bool varied = i < 32;
    points.emplace_back((varied ? 0.5 : 10.5) + 0.01 * (i % 32), 0.5 + 0.01 * (i * 7 % 32), 0.5);
    fields.shape_index.push_back(varied ? -1.0 + 2.0 * (i + 0.5) / 32.0 : 0.3);
    fields.segment.push_back(0);
  }
  const SurfaceGraph graph = test::point_graph(points);
  const std::vector<Index> picks = run(graph, fields, 14, 0.0, 1.0);
  EXPECT_EQ(std::count_if(picks.begin(), picks.end(), [](Index v) { return v < 32; }), 12) << "6 : 1 by 1 + H";
}

TEST(PaperSampling, FirstOfAVoxelIsNearestToItsCentroidThenTheFarthest) {
  std::vector<Vec3> points = {{0.1, 0.5, 0.5}, {0.52, 0.5, 0.5}, {0.9, 0.5, 0.5}, {0.3, 0.5, 0.5}, {0.7, 0.5, 0.5}};
  const SurfaceGraph graph = test::point_graph(points);
  const Fields fields{std::vector<double>(5, 0.0), std::vector<std::uint32_t>(5, 0)};
  EXPECT_EQ(run(graph, fields, 3, 0.0, 1.0), (std::vector<Index>{1, 0, 2}));
}

TEST(PaperSampling, AnyVoxelSizeGivesTheCount) {
  const SurfaceGraph graph = test::ellipsoid_graph(500);
  const Fields fields = random_fields(500);
  for (const double size : {1e-300, 1e-30, 1e-12, 1e-3, 0.1, 1.0, 1e6, 1e300}) {
    SCOPED_TRACE(size);
    expect_exact(run(graph, fields, 123, 0.3, size), 123);
  }
}

TEST(PaperSampling, AwkwardPlacesGiveTheCount) {
  std::vector<Vec3> line, clusters;
  for (int i = 0; i < 100; ++i) {
    line.emplace_back(i, 0.0, 0.0);
    clusters.emplace_back((i % 2) + 1e-9 * i, 0.0, 0.0);
  }
  for (const auto& points : {line, clusters, std::vector<Vec3>(100, Vec3(1, 2, 3))}) {
    for (const double area : {1.0, 0.0}) {
      const SurfaceGraph graph = test::point_graph(points, {}, std::vector<double>(100, area));
      for (const std::size_t count : {1u, 10u, 50u, 100u}) {
        SCOPED_TRACE(count);
        expect_exact(run(graph, random_fields(100), count, 0.3), count);
      }
    }
  }
}

TEST(PaperSampling, RefusesWhatDoesNotFit) {
  const SurfaceGraph graph = test::ellipsoid_graph(20);
  Fields fields = random_fields(20);
  EXPECT_THROW((void)run(graph, fields, 21, 0.65), InvalidInput);
  EXPECT_THROW((void)sample_paper(graph, std::vector<Index>{0, 20}, fields.shape_index, fields.segment, {.count = 1}),
               InvalidInput);
  EXPECT_THROW((void)run(graph, fields, 5, 1.5), InvalidInput);
  EXPECT_THROW((void)run(graph, fields, 5, 0.5, -1.0), InvalidInput);
  EXPECT_THROW((void)sample_paper(graph, test::all_vertices(graph), fields.shape_index, fields.segment, {.spacing = 0.1}),
               InvalidInput);
  fields.shape_index.pop_back();
  EXPECT_THROW((void)run(graph, fields, 5, 0.65), InvalidInput);
}

}  // namespace
}  // namespace shapelight
