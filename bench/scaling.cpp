// What every stage costs, and how that grows: CPU microseconds per vertex on a mesh cut ever finer and on its vertices
// as a raw cloud, with one thread and with two; peak memory; k-nearest-neighbour queries against nanoflann.
//
//   scaling MESH [LEVELS]      LEVELS (default 1): times that every triangle is cut into four
//
// Prints Markdown. CPU time is that of the process, all threads; wall time is beside it for two threads.

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "finer_mesh.hpp"
#include "shapelight/denoise/non_local_means.hpp"
#include "shapelight/features/curvature.hpp"
#include "shapelight/features/noise.hpp"
#include "shapelight/features/shape_index.hpp"
#include "shapelight/features/surface_variation.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/io/io.hpp"
#include "shapelight/retinex/retinex.hpp"
#include "shapelight/sample/shape_sampling.hpp"
#include "shapelight/segment/segmentation.hpp"
#include "shapelight/spatial/kd_tree.hpp"

#ifdef SHAPELIGHT_HAVE_NANOFLANN
#include <nanoflann.hpp>
#endif

namespace {

using namespace shapelight;

constexpr std::size_t kNeighbors = 12;

struct Seconds {
  double cpu = 0.0;
  double wall = 0.0;
};

Seconds measure(const std::function<void()>& work) {
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  work();
  return {static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count()};
}

// Gives freed memory back, so that it does not hide what comes next, and lets the peak start anew (Linux).
void reset_peak_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return 1024.0 * std::strtod(line.c_str() + 6, nullptr);
  }
  return 0.0;
}

using StageSeconds = std::vector<std::pair<std::string, Seconds>>;

// Every stage as compute_fields() and sample() run them on clean input, and those that run on noisy input only.
StageSeconds run_stages(const Geometry& geometry, const RunContext& context) {
  StageSeconds seconds;
  const auto stage = [&](const char* name, const std::function<void()>& work) {
    seconds.emplace_back(name, measure(work));
  };
  const bool is_cloud = geometry.kind() == GeometryKind::Cloud;
  SurfaceGraph graph;
  double noise = 0.0;
  Curvatures curvatures;
  std::vector<double> bend, variation, shape_index, density;
  RetinexResult split;
  stage("graph", [&] { graph = build_graph(geometry, {}, context).graph; });
  stage("noise", [&] { noise = estimate_noise(graph, context); });
  stage("curvature", [&] {
    CurvatureOptions options;
    if (is_cloud) options = {.method = CurvatureMethod::Quadric, .smoothing_passes = 0};
    curvatures = estimate_curvatures(graph, options, context);
  });
  stage("surface variation", [&] { variation = compute_surface_variation(graph, {}, context); });
  stage("shape index", [&] { shape_index = compute_shape_index(graph, curvatures, noise, {}, context); });
  stage("non-local means", [&] { (void)non_local_means(graph, shape_index, curvatures.direction1, {}, context); });
  stage("Retinex", [&] { split = decompose_retinex(graph, shape_index, {}, context); });
  stage("segmentation", [&] { (void)segment_field(graph, split.reflectance, {}, context); });
  stage("importance", [&] {
    for (std::size_t i = 0; i < graph.size(); ++i) bend.push_back(curvedness(curvatures.k1[i], curvatures.k2[i]));
    density = sampling_density(graph, {bend, variation, shape_index, split.reflectance, false}, context);
  });
  stage("ranking, 10 %", [&] {
    std::vector<Index> candidates;
    for (Index v = 0; v < graph.size(); ++v) {
      if (!graph.outlier[v]) candidates.push_back(v);
    }
    const SamplingTarget target{std::max<std::size_t>(1, candidates.size() / 10), 0.0};
    (void)sample_by_shape(graph, candidates, density, target, {}, context);
  });
  return seconds;
}

void print_stages(const Geometry& geometry) {
  const auto n = static_cast<double>(geometry.size());
  reset_peak_memory();
  const double before = peak_memory_bytes();
  const StageSeconds one = run_stages(geometry, {.max_threads = 1, .stop = {}, .progress = {}});
  const double memory = peak_memory_bytes() - before;
  const StageSeconds two = run_stages(geometry, {.max_threads = 2, .stop = {}, .progress = {}});
  fmt::print("\n### {} of {} vertices\n\n", geometry_kind_name(geometry.kind()), geometry.size());
  fmt::print("| stage | CPU us/vertex, 1 thread | CPU, 2 threads | wall, 2 threads |\n| --- | ---: | ---: | ---: |\n");
  const auto row = [&](const std::string& name, const Seconds& a, const Seconds& b) {
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} |\n", name, 1e6 * a.cpu / n, 1e6 * b.cpu / n, 1e6 * b.wall / n);
  };
  Seconds sum_one;
  Seconds sum_two;
  for (std::size_t i = 0; i < one.size(); ++i) {
    row(one[i].first, one[i].second, two[i].second);
    sum_one.cpu += one[i].second.cpu;
    sum_two.cpu += two[i].second.cpu;
    sum_two.wall += two[i].second.wall;
  }
  row("all of them", sum_one, sum_two);
  fmt::print("\nPeak memory beyond the input: {:.0f} bytes per vertex.\n", memory / n);
  std::fflush(stdout);
}

#ifdef SHAPELIGHT_HAVE_NANOFLANN
struct PointAdaptor {
  const std::vector<Vec3>& points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<long>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

void measure_nanoflann(const std::vector<Vec3>& points, const std::function<void(const char*, Seconds, Seconds)>& row) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointAdaptor>, PointAdaptor, 3,
                                                   std::uint32_t>;
  const PointAdaptor adaptor{points};
  std::unique_ptr<Tree> tree;
  const Seconds build = measure([&] { tree = std::make_unique<Tree>(3, adaptor); });
  const Seconds query = measure([&] {
    std::vector<std::uint32_t> index(kNeighbors);
    std::vector<double> distance_sq(kNeighbors);
    for (const Vec3& p : points) tree->knnSearch(p.data(), kNeighbors, index.data(), distance_sq.data());
  });
  row("nanoflann, single queries", build, query);
}
#endif

void print_neighbors(const std::vector<Vec3>& points) {
  const auto n = static_cast<double>(points.size());
  fmt::print("\n### {} nearest neighbours of {} points, one thread\n\n", kNeighbors, points.size());
  fmt::print("| | build, us/point | queries/s |\n| --- | ---: | ---: |\n");
  const auto row = [&](const char* name, Seconds build, Seconds query) {
    fmt::print("| {} | {:.2f} | {:.0f} |\n", name, 1e6 * build.cpu / n, n / query.cpu);
  };
  std::unique_ptr<KdTree> tree;
  const Seconds build = measure([&] { tree = std::make_unique<KdTree>(points); });
  row("KdTree::all_nearest", build,
      measure([&] { (void)tree->all_nearest(kNeighbors, {.max_threads = 1, .stop = {}, .progress = {}}); }));
  row("KdTree::nearest, single queries", build, measure([&] {
        std::vector<Neighbor> found;
        for (const Vec3& p : points) tree->nearest(p, kNeighbors, found);
      }));
#ifdef SHAPELIGHT_HAVE_NANOFLANN
  measure_nanoflann(points, row);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: scaling MESH [LEVELS]\n");
    return 2;
  }
  try {
    const int levels = argc > 2 ? std::atoi(argv[2]) : 1;
    Geometry mesh = read_geometry(argv[1]);
    for (int level = 0; level <= levels; ++level) {
      if (level > 0) mesh = bench::finer_mesh(mesh, 2);
      print_stages(mesh);
      Geometry cloud;
      cloud.positions = mesh.positions;
      print_stages(cloud);
      print_neighbors(mesh.positions);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "scaling: {}\n", error.what());
    return 1;
  }
  return 0;
}
