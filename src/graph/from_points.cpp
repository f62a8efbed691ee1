#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "graph/canonical_order.hpp"
#include "graph/components.hpp"
#include "graph/finish_graph.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight {
namespace {

constexpr double kSparseLocal = 4.0;     // r_k against the median r_k of the neighbours
constexpr double kSparseGlobal = 6.0;    // r_k against the median r_k of the cloud
constexpr double kSparseShare = 0.02;    // when more points exceed that, the cloud is uneven by nature, as lidar is
constexpr double kStrayHeight = 0.3;     // a stray stands off the tangent planes of its nearest: mean |n'.d| / |d|
constexpr std::size_t kStrayGroup = 50;  // [points] small groups apart from everything are strays as well
constexpr double kBoundaryOffset = 0.4;  // |mean of neighbours| / mean distance: 0 inside, 0.64 on a straight border
constexpr int kWeightLevels = 1 << 16;   // resolution of 1 - |n.n'| in the spanning tree

// Row i: the k nearest of vertex i, nearest first, kNoIndex at the end where there are fewer.
struct NearestTable {
  std::size_t k;
  std::vector<Index> index;
  [[nodiscard]] std::span<const Index> of(std::size_t i) const {
    std::span<const Index> row(index.data() + i * k, k);
    while (!row.empty() && row.back() == kNoIndex) row = row.first(row.size() - 1);
    return row;
  }
};

void connect(SurfaceGraph& graph, const NearestTable& nearest, const RunContext& context) {
  const std::size_t n = graph.size();
  // Count i -> j and its mirror j -> i, then sort and drop what was mutual.
  std::vector<std::uint32_t> start(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    poll(context, i);
    for (const Index j : nearest.of(i)) {
      ++start[i + 1];
      ++start[j + 1];
    }
  }
  for (std::size_t i = 0; i < n; ++i) start[i + 1] += start[i];
  std::vector<Index> ends(start[n]);
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    poll(context, i);
    for (const Index j : nearest.of(i)) {
      ends[next[i]++] = j;
      ends[next[j]++] = static_cast<Index>(i);
    }
  }
  std::vector<std::uint32_t> degree(n);
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto first = ends.begin() + start[i];
      const auto last = ends.begin() + start[i + 1];
      std::sort(first, last);
      degree[i] = static_cast<std::uint32_t>(std::unique(first, last) - first);
    }
  });
  for (std::size_t i = 0; i < n; ++i) graph.offsets[i + 1] = graph.offsets[i] + degree[i];
  graph.neighbors.resize(graph.offsets[n]);
  graph.weight.resize(graph.offsets[n]);
  for (std::size_t i = 0; i < n; ++i) {
    poll(context, i);
    std::copy_n(ends.begin() + start[i], degree[i], graph.neighbors.begin() + graph.offsets[i]);
  }
}

// Normal by principal components, area, boundary flag; returns r_k.
double fit_vertex(SurfaceGraph& graph, std::span<const Index> nearest, std::size_t i) {
  if (nearest.empty()) return 0.0;
  const Vec3& center = graph.position[i];
  const double count = static_cast<double>(nearest.size());
  Vec3 mean = Vec3::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  double distance_sum = 0.0;
  for (const Index j : nearest) {
    const Vec3 d = graph.position[j] - center;
    mean += d;
    moments += d * d.transpose();
    distance_sum += d.norm();
  }
  const double radius = (graph.position[nearest.back()] - center).norm();
  graph.area[i] = std::numbers::pi * radius * radius / count;
  graph.boundary[i] = mean.norm() > kBoundaryOffset * distance_sum;

  mean /= count + 1.0;  // the point itself is one of them
  const Eigen::Matrix3d covariance = moments / (count + 1.0) - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance / std::max(radius * radius, 1e-300));
  const bool is_surface = nearest.size() >= 3 && solver.eigenvalues()[1] > 1e-10;  // not all on one line
  graph.normal[i] = is_surface ? Vec3(solver.eigenvectors().col(0).normalized()) : Vec3::Zero();
  return radius;
}

// Hoppe et al. 1992: signs spread along the minimum spanning tree of 1 - |n.n'|. Kruskal with signed sets needs no
// walk over the tree; a counting sort over quantised weights keeps it linear, ties in the order of the vertices.
void orient_along_spanning_tree(SurfaceGraph& graph, const RunContext& context) {
  std::vector<std::uint32_t> start(kWeightLevels + 1, 0);
  const auto level = [&](Index i, Index j) {
    const double weight = 1.0 - std::abs(graph.normal[i].dot(graph.normal[j]));
    return static_cast<int>(std::clamp(weight, 0.0, 1.0) * (kWeightLevels - 1));
  };
  const auto for_edges = [&](auto&& visit) {
    for (Index i = 0; i < graph.size(); ++i) {
      poll(context, i);
      for (const Index j : graph.neighbors_of(i)) {
        if (j > i) visit(i, j);
      }
    }
  };
  for_edges([&](Index i, Index j) { ++start[level(i, j) + 1]; });
  for (int l = 0; l < kWeightLevels; ++l) start[l + 1] += start[l];
  std::vector<std::pair<Index, Index>> edges(start[kWeightLevels]);
  for_edges([&](Index i, Index j) { edges[start[level(i, j)]++] = {i, j}; });

  SignedUnionFind sets(graph.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    poll(context, e);
    const auto& [i, j] = edges[e];
    sets.unite(i, j, graph.normal[i].dot(graph.normal[j]) < 0.0);
  }
  for (Index i = 0; i < graph.size(); ++i) {
    poll(context, i);
    if (sets.find(i).second != 0) graph.normal[i] = -graph.normal[i];
  }
}

// Sparse points: r_k stands out. By itself that is no fault: scans thin out with range, meshes with curvature.
enum class Sparse : std::uint8_t { No, Locally, Globally };

std::vector<Sparse> find_sparse(const NearestTable& nearest, std::span<const double> radius,
                                const RunContext& context) {
  const std::size_t n = radius.size();
  std::vector<double> sorted(radius.begin(), radius.end());
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n / 2), sorted.end());
  const double limit = kSparseGlobal * sorted[n / 2];
  const auto beyond = std::count_if(radius.begin(), radius.end(), [&](double r) { return r > limit; });
  const bool is_even = static_cast<double>(beyond) <= kSparseShare * static_cast<double>(n);
  std::vector<Sparse> sparse(n, Sparse::No);
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    std::vector<double> around;
    for (std::size_t i = begin; i < end; ++i) {
      around.clear();
      for (const Index j : nearest.of(i)) around.push_back(radius[j]);
      if (around.empty()) continue;
      std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2), around.end());
      if (is_even && radius[i] > limit)
        sparse[i] = Sparse::Globally;
      else if (radius[i] > kSparseLocal * around[around.size() / 2])
        sparse[i] = Sparse::Locally;
    }
  });
  return sparse;
}

double height_over(const SurfaceGraph& graph, std::span<const Index> nearest, std::size_t i) {
  double sum = 0.0;
  for (const Index j : nearest) {
    const Vec3 d = graph.position[i] - graph.position[j];
    sum += std::abs(graph.normal[j].dot(d)) / d.norm();
  }
  return sum / static_cast<double>(nearest.size());
}

void flag_strays(SurfaceGraph& graph, const NearestTable& nearest, std::span<const double> radius,
                 const RunContext& context) {
  const std::size_t n = graph.size();
  const std::vector<Sparse> sparse = find_sparse(nearest, radius, context);
  // A stray is near to no dense point, while sparse points of a surface are near to those beside them.
  std::vector<std::uint8_t> near_dense(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    poll(context, i);
    if (sparse[i] != Sparse::No) continue;
    for (const Index j : nearest.of(i)) near_dense[j] = 1;
  }
  const std::vector<Index> root = component_roots(graph, context);
  std::vector<Index> component_size(n, 0);
  for (const Index r : root) ++component_size[r];
  const std::size_t group = std::min(kStrayGroup, n / 10);
  for (std::size_t i = 0; i < n; ++i) {
    poll(context, i);
    if (sparse[i] == Sparse::No) continue;
    const bool apart = sparse[i] == Sparse::Globally && component_size[root[i]] <= group;
    const bool floats = near_dense[i] == 0 && height_over(graph, nearest.of(i), i) > kStrayHeight;
    graph.outlier[i] = apart || floats;
  }
}

}  // namespace

BuiltGraph graph_from_points(std::span<const Vec3> positions, const std::optional<Vec3>& viewpoint,
                             const GraphOptions& options, const RunContext& context) {
  validate_options(options);
  BuiltGraph built = start_graph(positions, context.phase(0.0, 0.1, "order points"));
  SurfaceGraph& graph = built.graph;
  const std::size_t n = graph.size();

  const RunContext search = context.phase(0.1, 0.6, "find neighbours");
  const auto k = static_cast<std::size_t>(options.neighbors);
  const NearestTable nearest{k, KdTree(graph.position, search).all_nearest(k, search)};
  connect(graph, nearest, search);

  const RunContext fit = context.phase(0.6, 0.8, "estimate normals");
  std::vector<double> radius(n);
  parallel::for_chunks(fit, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) radius[i] = fit_vertex(graph, nearest.of(i), i);
  });
  for (std::size_t i = 0; i < n; ++i) {
    poll(fit, i);
    const auto degree = static_cast<double>(graph.neighbors_of(i).size());
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      graph.weight[e] = static_cast<float>(6.0 * graph.area[i] / degree);
    }
  }

  const RunContext orient = context.phase(0.8, 1.0, "orient normals");
  orient_along_spanning_tree(graph, orient);
  orient_components(graph, viewpoint, orient);
  if (options.flag_outliers && n > 0) flag_strays(graph, nearest, radius, orient);
  finish_graph(built, orient);
  return built;
}

}  // namespace shapelight
