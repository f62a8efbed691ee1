#include "shapelight/segment/segmentation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;
using Labels = std::vector<std::uint32_t>;

SegmentationOptions only_predicate(double scale) { return {scale, 0, 0.0}; }

std::vector<double> random_field(std::size_t n, std::uint64_t seed) {
  std::vector<double> field(n);
  // Few distinct values, exact in single precision, so that ties are common.
  for (std::size_t i = 0; i < n; ++i) field[i] = static_cast<double>(random_bits(seed, 0, i) % 9) / 8.0;
  return field;
}

Labels canonical(const Labels& label) {
  std::map<std::uint32_t, std::uint32_t> number;
  Labels result;
  for (const std::uint32_t l : label)
    result.push_back(number.try_emplace(l, static_cast<std::uint32_t>(number.size())).first->second);
  return result;
}

struct Edge {
  double w;
  Index i, j;
  friend bool operator<(const Edge& a, const Edge& b) { return std::tie(a.w, a.i, a.j) < std::tie(b.w, b.i, b.j); }
};

std::vector<Edge> edges_of(const SurfaceGraph& graph, const std::vector<double>& field) {
  std::vector<Edge> edges;
  for (Index i = 0; i < graph.size(); ++i) {
    for (const Index j : graph.neighbors_of(i)) {
      if (i < j) edges.push_back({std::abs(field[i] - field[j]), i, j});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Int of eq. 12: the heaviest edge of the minimum spanning tree within one region (Kruskal).
double internal_difference(const std::vector<Edge>& sorted, const Labels& label, std::uint32_t region) {
  std::vector<std::size_t> tree(label.size());
  for (std::size_t i = 0; i < tree.size(); ++i) tree[i] = i;
  double heaviest = 0.0;
  for (const Edge& e : sorted) {
    if (label[e.i] != region || label[e.j] != region || tree[e.i] == tree[e.j]) continue;
    std::replace(tree.begin(), tree.end(), std::size_t{tree[e.j]}, std::size_t{tree[e.i]});
    heaviest = e.w;
  }
  return heaviest;
}

// Definition 1: some pair of adjacent regions shows no evidence for a boundary (eq. 9 to 11).
bool too_fine(const std::vector<Edge>& sorted, const Labels& label, double scale) {
  const std::uint32_t count = 1 + *std::max_element(label.begin(), label.end());
  std::vector<double> tolerance(count);
  for (std::uint32_t r = 0; r < count; ++r) {
    tolerance[r] =
        internal_difference(sorted, label, r) + scale / static_cast<double>(std::count(label.begin(), label.end(), r));
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> least;  // Dif of eq. 10
  for (const Edge& e : sorted) {
    if (label[e.i] != label[e.j]) least.try_emplace(std::minmax(label[e.i], label[e.j]), e.w);
  }
  return std::any_of(least.begin(), least.end(), [&](const auto& pair) {
    return pair.second <= std::min(tolerance[pair.first.first], tolerance[pair.first.second]);
  });
}

Labels naive(const SurfaceGraph& graph, const std::vector<double>& field, double scale) {
  const std::vector<Edge> sorted = edges_of(graph, field);
  Labels label(graph.size());
  for (std::uint32_t i = 0; i < label.size(); ++i) label[i] = i;
  for (const Edge& e : sorted) {
    const std::uint32_t a = label[e.i], b = label[e.j];
    if (a == b) continue;
    const auto tolerance = [&](std::uint32_t r) {
      return internal_difference(sorted, label, r) +
             scale / static_cast<double>(std::count(label.begin(), label.end(), r));
    };
    if (e.w <= std::min(tolerance(a), tolerance(b)))
      std::replace(label.begin(), label.end(), std::uint32_t{b}, std::uint32_t{a});
  }
  return canonical(label);
}

TEST(Segmentation, AgreesWithTheNaiveForm) {
  const SurfaceGraph graph = graph_of_mesh(plane(8, 1.0));
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::vector<double> field = random_field(graph.size(), seed);
    for (const double scale : {0.0, 0.25, 1.0, 4.0}) {
      EXPECT_EQ(segment_field(graph, field, only_predicate(scale)).label, naive(graph, field, scale))
          << seed << " " << scale;
    }
  }
}

TEST(Segmentation, IsNotTooFine) {
  const SurfaceGraph graph = graph_of_mesh(torus(14, 8, 2.0, 0.7));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<double> field = random_field(graph.size(), seed);
    const auto edges = edges_of(graph, field);
    EXPECT_FALSE(too_fine(edges, segment_field(graph, field, only_predicate(0.5)).label, 0.5)) << seed;
  }
}

// Definition 2, over all refinements of small segmentations: every proper one is too fine.
TEST(Segmentation, IsNotTooCoarse) {
  const std::set<std::pair<Index, Index>> links = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5},
                                                   {0, 3}, {1, 4}, {2, 5}, {0, 4}};
  const SurfaceGraph graph = graph_of_edges(std::vector<Vec3>(6, Vec3::Zero()), links);
  std::size_t refinements = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::vector<double> field = random_field(6, seed);
    const auto edges = edges_of(graph, field);
    const Labels found = segment_field(graph, field, only_predicate(0.3)).label;
    for (std::uint32_t code = 0; code < 6 * 6 * 6 * 6 * 6 * 6; ++code) {
      Labels label;
      for (std::uint32_t rest = code; label.size() < 6; rest /= 6) label.push_back(rest % 6);
      if (label != canonical(label) || label == found) continue;
      bool refines = true;
      for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < i; ++j) refines = refines && (label[i] != label[j] || found[i] == found[j]);
      }
      if (!refines) continue;
      // Regions must be connected: a spanning tree within each must reach all of its vertices.
      Labels component = label;
      for (std::size_t i = 0; i < 6; ++i) component[i] = static_cast<std::uint32_t>(i);
      for (const Edge& e : edges) {
        if (label[e.i] == label[e.j])
          std::replace(component.begin(), component.end(), std::uint32_t{component[e.j]},
                       std::uint32_t{component[e.i]});
      }
      if (canonical(component) != label) continue;
      ++refinements;
      EXPECT_TRUE(too_fine(edges, label, 0.3)) << seed << " " << code;
    }
  }
  EXPECT_GT(refinements, 100U);
}

TEST(Segmentation, CutsAtAStepAndNowhereElse) {
  const SurfaceGraph graph = graph_of_mesh(plane(20, 1.0));
  std::vector<double> field(graph.size());
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = (i % 20 < 10 ? 0.0 : 0.6) + 0.01 * random01(1, 0, i);
  const SegmentationResult found = segment_field(graph, field);
  EXPECT_EQ(found.count, 2U);
  for (std::size_t i = 0; i < field.size(); ++i) EXPECT_EQ(found.label[i], i % 20 < 10 ? 0U : 1U);
}

TEST(Segmentation, SmallSegmentsJoinTheNeighbourWithTheWeakestEdge) {
  // 0 1 2 | 3 | 4 5 6 on a line: vertex 3 is nearer to its right neighbours.
  std::vector<Vec3> line(7);
  std::set<std::pair<Index, Index>> links;
  for (Index i = 0; i < 7; ++i) line[i] = Vec3(i, 0, 0);
  for (Index i = 0; i < 6; ++i) links.emplace(i, i + 1);
  const SurfaceGraph graph = graph_of_edges(line, links);
  const std::vector<double> field = {0, 0, 0, 0.6, 1, 1, 1};
  EXPECT_EQ(segment_field(graph, field, {0.01, 0, 0.0}).label, (Labels{0, 0, 0, 1, 2, 2, 2}));
  EXPECT_EQ(segment_field(graph, field, {0.01, 2, 0.0}).label, (Labels{0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(segment_field(graph, field, {0.01, 0, 0.2}).label, (Labels{0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(segment_field(graph, field, {0.01, 7, 0.0}).count, 1U);
}

TEST(Segmentation, EmptyIsolatedAndBadInput) {
  EXPECT_EQ(segment_field(isolated(0), {}).count, 0U);
  EXPECT_EQ(segment_field(isolated(1), std::vector<double>{0.5}).count, 1U);
  EXPECT_EQ(segment_field(isolated(3), std::vector<double>(3, 0.5)).label, (Labels{0, 1, 2}));
  EXPECT_THROW(static_cast<void>(segment_field(isolated(3), std::vector<double>(2, 0.5))), InvalidInput);
  EXPECT_THROW(
      static_cast<void>(segment_field(isolated(1), std::vector<double>{std::numeric_limits<double>::quiet_NaN()})),
      InvalidInput);
}

TEST(Segmentation, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(sphere(5, 1.0));
  const std::vector<double> field = random_field(graph.size(), 3);
  expect_same_for_any_number_of_threads(
      [&](const RunContext& context) { return segment_field(graph, field, {}, context).label; });
}

}  // namespace
}  // namespace shapelight
