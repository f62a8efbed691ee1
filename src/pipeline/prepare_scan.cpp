#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/sample_graph.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/pipeline/register.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kFewest = 10;           // [points] that a registration asks for
constexpr double kDefaultRatio = 0.05;        // of the points are registered, but no fewer and no more than
constexpr std::size_t kDefaultFewest = 2000;  // [points]
constexpr std::size_t kDefaultMost = 10000;   // [points]
constexpr std::size_t kKeypoints = 2000;      // [points]

// Places of the scan, each once, strays left out; of_vertex says where a vertex of the graph went.
struct Places {
  std::vector<Vec3> position, normal;
  std::vector<Index> of_vertex;
};

Places places_of(const SurfaceGraph& graph) {
  Places places;
  places.of_vertex.assign(graph.size(), kNoIndex);
  for (std::size_t v = 0; v < graph.size(); ++v) {
    if (graph.outlier[v]) continue;
    places.of_vertex[v] = static_cast<Index>(places.position.size());
    places.position.push_back(graph.position[v]);
    places.normal.push_back(graph.normal[v]);
  }
  return places;
}

// Chosen points as indices of places.
std::vector<Index> choose(const BuiltGraph& built, const Places& places, GeometryKind kind, std::size_t count,
                          const SampleOptions& options, const RunContext& context) {
  const SurfaceGraph& graph = built.graph;
  std::size_t available = 0;
  for (std::size_t v = 0; v < graph.size(); ++v) {
    available += graph.outlier[v] == 0 && !(options.skip_boundary && graph.boundary[v] != 0);
  }
  SampleSize size;
  size.count = std::min(count, available);
  std::vector<Index> chosen;
  if (*size.count == 0) return chosen;
  const SampleResult sampled = sample_graph(built, kind, size, options, context);
  for (const Index point : sampled.indices) chosen.push_back(places.of_vertex[graph.vertex_of_point[point]]);
  return chosen;
}

std::size_t sample_count(const RegisterOptions& options, std::size_t num_places) {
  const auto share = [&](double ratio) { return static_cast<std::size_t>(std::llround(ratio * double(num_places))); };
  if (options.ratio > 0.0) return std::max(share(options.ratio), std::min(kFewest, num_places));
  return std::min(num_places, std::clamp(share(kDefaultRatio), kDefaultFewest, kDefaultMost));
}

RegistrationCloud subset(const Places& places, std::span<const Index> chosen, const RunContext& context) {
  std::vector<Vec3> position, normal;
  for (const Index i : chosen) {
    position.push_back(places.position[i]);
    normal.push_back(places.normal[i]);
  }
  return RegistrationCloud(std::move(position), std::move(normal), context);
}

}  // namespace

PreparedScan prepare_scan(const Geometry& geometry, const RegisterOptions& options, const RunContext& context) {
  validate_options(options);
  const BuiltGraph built = build_graph(geometry, {}, context.phase(0.0, 0.3, "build graph"));
  Places places = places_of(built.graph);
  if (places.position.size() < kFewest) {
    throw InvalidInput(fmt::format("a scan of {} distinct finite points cannot be registered, expected {} or more",
                                   places.position.size(), kFewest));
  }

  SampleOptions sampling = sample_preset(Preset::Detail);
  sampling.skip_boundary = options.skip_boundary;
  sampling.seed = options.seed;
  const std::size_t count = sample_count(options, places.position.size());
  std::vector<Index> samples, keypoints;
  if (options.sampler == SamplingMethod::Shape) {  // a ranking: both are prefixes of it
    samples = choose(built, places, geometry.kind(), std::max(count, kKeypoints), sampling,
                     context.phase(0.3, 0.9, "choose points"));
    keypoints.assign(samples.begin(), samples.begin() + std::min(samples.size(), kKeypoints));
    samples.resize(std::min(samples.size(), count));
  } else {
    if (options.coarse) {
      keypoints =
          choose(built, places, geometry.kind(), kKeypoints, sampling, context.phase(0.3, 0.7, "choose keypoints"));
    }
    sampling.method = options.sampler;
    samples = choose(built, places, geometry.kind(), count, sampling, context.phase(0.7, 0.9, "choose points"));
  }
  if (samples.size() < kFewest) {
    throw InvalidInput(fmt::format("only {} points of the scan can be chosen, expected {} or more{}", samples.size(),
                                   kFewest,
                                   options.skip_boundary ? "; --no-skip-boundary allows those on its border" : ""));
  }
  const RunContext build = context.phase(0.9, 1.0, "build trees");
  RegistrationCloud thinned = subset(places, samples, build);
  RegistrationCloud full(std::move(places.position), std::move(places.normal), build);
  if (geometry.viewpoint) full.viewpoint = *geometry.viewpoint - built.graph.origin;
  return {built.graph.origin, std::move(full), std::move(thinned), std::move(keypoints)};
}

}  // namespace shapelight
