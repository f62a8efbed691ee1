#include "shapelight/denoise/non_local_means.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/random.hpp"
#include "core/tangent_frame.hpp"
#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/graphs.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

std::vector<Vec3> any_directions(const SurfaceGraph& graph) {
  std::vector<Vec3> directions(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i) directions[i] = tangent_frame(graph.normal[i]).x;
  return directions;
}

std::vector<double> random_field(std::size_t n) {
  std::vector<double> field(n);
  for (std::size_t i = 0; i < n; ++i) field[i] = 2.0 * random01(9, 0, i) - 1.0;
  return field;
}

// The definition as written, in double precision: no bound, no permutations shared, weights where they belong.
namespace oracle {

using Net = Eigen::Matrix4d;

double basis(int k, double u) {
  const double v = 1.0 - u;
  switch (k) {
    case 0:
      return v * v * v / 6.0;
    case 1:
      return (3 * u * u * u - 6 * u * u + 4) / 6.0;
    case 2:
      return (3 * v * v * v - 6 * v * v + 4) / 6.0;
    default:
      return u * u * u / 6.0;
  }
}

Net patch(const SurfaceGraph& graph, const std::vector<double>& field, const Vec3& x_axis, Index i) {
  RingCollector rings(graph);
  const Vec3 y_axis = graph.normal[i].cross(x_axis);
  std::vector<Vec3> points;
  double radius = 0.0, mean = 0.0;
  for (const Index j : rings.collect(i, 2, 64)) {
    const Vec3 d = graph.position[j] - graph.position[i];
    points.emplace_back(d.dot(x_axis), d.dot(y_axis), field[j]);
    radius = std::max(radius, points.back().head<2>().norm());
    mean += field[j];
  }
  mean /= static_cast<double>(points.size());
  Net asked = Net::Zero(), weight = Net::Zero();
  for (const Vec3& p : points) {
    Net w;
    for (int k = 0; k < 4; ++k) {
      for (int l = 0; l < 4; ++l) w(k, l) = basis(k, 0.5 + 0.5 * p.x() / radius) * basis(l, 0.5 + 0.5 * p.y() / radius);
    }
    asked += w.cwiseProduct(w).cwiseProduct(w) * (p.z() - mean) / w.squaredNorm();
    weight += w.cwiseProduct(w);
  }
  return (asked.cwiseQuotient(weight)).array() + mean;
}

double distance(const Net& a, Net b) {
  double least = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < 4; ++turn) {
    double sum = 0.0, total = 0.0;
    for (int k = 0; k < 4; ++k) {
      for (int l = 0; l < 4; ++l) {
        const double g = std::exp(-0.5 * ((k - 1.5) * (k - 1.5) + (l - 1.5) * (l - 1.5)));
        sum += g * (a(k, l) - b(k, l)) * (a(k, l) - b(k, l));
        total += g;
      }
    }
    least = std::min(least, sum / total);
    b = Net(b.transpose().colwise().reverse());
  }
  return least;
}

std::vector<double> filter(const SurfaceGraph& graph, const std::vector<double>& field,
                           const std::vector<Vec3>& directions) {
  std::vector<Net> nets;
  for (Index i = 0; i < graph.size(); ++i) nets.push_back(patch(graph, field, directions[i], i));
  std::vector<double> between;
  for (Index i = 0; i < graph.size(); ++i) {
    for (const Index j : graph.neighbors_of(i)) between.push_back(distance(nets[i], nets[j]));
  }
  std::sort(between.begin(), between.end());
  const double d_sq = 2.0 * between[between.size() / 2];
  std::vector<double> result;
  RingCollector rings(graph);
  for (Index i = 0; i < graph.size(); ++i) {
    double sum = 0.0, total = 0.0, largest = 0.0;
    for (const Index j : rings.collect(i, 3, 65)) {
      const double ratio = distance(nets[i], nets[j]) / d_sq;
      if (j == i || ratio > 8.0) continue;
      sum += std::exp(-ratio) * field[j];
      total += std::exp(-ratio);
      largest = std::max(largest, std::exp(-ratio));
    }
    result.push_back(largest > 0.0 ? (sum + largest * field[i]) / (total + largest) : field[i]);
  }
  return result;
}

}  // namespace oracle

TEST(NonLocalMeans, AgreesWithTheDefinition) {
  const SurfaceGraph graph = graph_of_mesh(with_noise(sphere(2, 1.0, 0.2), 0.01));
  const std::vector<double> field = random_field(graph.size());
  const std::vector<Vec3> directions = any_directions(graph);
  const std::vector<double> found = non_local_means(graph, field, directions);
  const std::vector<double> expected = oracle::filter(graph, field, directions);
  for (std::size_t i = 0; i < field.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-3) << i;
}

TEST(NonLocalMeans, QuarterTurnsOfTheFrameChangeNothing) {
  const SurfaceGraph graph = graph_of_mesh(sphere(3, 1.0, 0.2));
  const std::vector<double> field = random_field(graph.size());
  const std::vector<Vec3> directions = any_directions(graph);
  std::vector<Vec3> turned = directions;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    for (std::uint64_t turns = random_bits(1, 1, i) % 4; turns > 0; --turns)
      turned[i] = graph.normal[i].cross(turned[i]);
  }
  const std::vector<double> a = non_local_means(graph, field, directions), b = non_local_means(graph, field, turned);
  for (std::size_t i = 0; i < field.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-4);
}

TEST(NonLocalMeans, AConstantStaysAndAnOffsetPassesThrough) {
  const SurfaceGraph graph = graph_of_mesh(sphere(3, 1.0, 0.2));
  const std::vector<Vec3> directions = any_directions(graph);
  for (const double v : non_local_means(graph, std::vector<double>(graph.size(), 0.7), directions))
    EXPECT_NEAR(v, 0.7, 1e-12);
  std::vector<double> field = random_field(graph.size());
  const std::vector<double> a = non_local_means(graph, field, directions);
  for (double& v : field) v += 0.5;
  const std::vector<double> b = non_local_means(graph, field, directions);
  for (std::size_t i = 0; i < field.size(); ++i) EXPECT_NEAR(b[i] - a[i], 0.5, 1e-3);
}

TEST(NonLocalMeans, TakesNoiseAwayAndKeepsAStep) {
  const SurfaceGraph graph = graph_of_mesh(plane(40, 1.0, 0.2));
  std::vector<double> clean(graph.size()), noisy(graph.size());
  for (std::size_t i = 0; i < clean.size(); ++i) {
    clean[i] = i % 40 < 20 ? -0.5 : 0.5;
    noisy[i] = clean[i] + 0.1 * gaussian(3, 0, i);
  }
  const std::vector<double> found = non_local_means(graph, noisy, any_directions(graph));
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    before += (noisy[i] - clean[i]) * (noisy[i] - clean[i]);
    after += (found[i] - clean[i]) * (found[i] - clean[i]);
    EXPECT_GT(found[i] * clean[i], 0.0) << "the step moved at " << i;
  }
  EXPECT_LT(after, 0.3 * before);
}

TEST(NonLocalMeans, StaysWithinTheRangeOfTheField) {
  const SurfaceGraph graph = graph_of_points(sphere(2, 1.0, 0.2), 12);
  const std::vector<double> field = random_field(graph.size());
  const auto [low, high] = std::minmax_element(field.begin(), field.end());
  for (const double v : non_local_means(graph, field, any_directions(graph))) {
    EXPECT_GE(v, *low - 1e-12);
    EXPECT_LE(v, *high + 1e-12);
  }
}

TEST(NonLocalMeans, ATinyBandwidthChangesNothing) {
  const SurfaceGraph graph = graph_of_mesh(plane(12, 1.0, 0.2));
  const std::vector<double> field = random_field(graph.size());
  NonLocalMeansOptions options;
  options.bandwidth_sq = 1e-12;
  EXPECT_EQ(non_local_means(graph, field, any_directions(graph), options), field);
}

TEST(NonLocalMeans, EmptyIsolatedAndBadInput) {
  EXPECT_TRUE(non_local_means(isolated(0), {}, {}).empty());
  const std::vector<Vec3> none(3, Vec3::Zero());
  const std::vector<double> field = {1.0, -2.0, 3.0};
  EXPECT_EQ(non_local_means(isolated(3), field, none), field);
  EXPECT_THROW(static_cast<void>(non_local_means(isolated(2), field, none)), InvalidInput);
  EXPECT_THROW(static_cast<void>(non_local_means(isolated(3), field, {})), InvalidInput);
  const std::vector<double> bad = {1.0, std::numeric_limits<double>::infinity(), 3.0};
  EXPECT_THROW(static_cast<void>(non_local_means(isolated(3), bad, none)), InvalidInput);
}

TEST(NonLocalMeans, DoesNotDependOnThreads) {
  const SurfaceGraph graph = graph_of_mesh(sphere(5, 1.0));
  const std::vector<double> field = random_field(graph.size());
  const std::vector<Vec3> directions = any_directions(graph);
  expect_same_for_any_number_of_threads(
      [&](const RunContext& context) { return non_local_means(graph, field, directions, {}, context); });
}

}  // namespace
}  // namespace shapelight
