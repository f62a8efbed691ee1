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
constexpr std::size_t kMostLookedAt =
    60000;  // [points] that samples are chosen from, and never fewer than 4 per sample

// Places of the scan, each once, strays left out.
struct Places {
  std::vector<Vec3> position, normal;
  std::vector<Index> of_point;  // input point -> place, kNoIndex for strays and points without a finite position
};

Places places_of(const SurfaceGraph& graph) {
  Places places;
  std::vector<Index> of_vertex(graph.size(), kNoIndex);
  for (std::size_t v = 0; v < graph.size(); ++v) {
    if (graph.outlier[v]) continue;
    of_vertex[v] = static_cast<Index>(places.position.size());
    places.position.push_back(graph.position[v]);
    places.normal.push_back(graph.normal[v]);
  }
  places.of_point.reserve(graph.vertex_of_point.size());
  for (const Index v : graph.vertex_of_point) places.of_point.push_back(v == kNoIndex ? kNoIndex : of_vertex[v]);
  return places;
}

// What points are chosen from: the scan itself, or an even part of it when it is so large that the rest would only cost
// time.
struct Choosable {
  BuiltGraph built;
  GeometryKind kind;
  std::vector<Index> place_of_point;
};

Choosable choosable(BuiltGraph built, GeometryKind kind, const Places& places, std::size_t most,
                    const std::optional<Vec3>& viewpoint, const RunContext& context) {
  if (places.position.size() <= most) return {std::move(built), kind, places.of_point};
  const std::size_t step = (places.position.size() + most - 1) / most;  // places lie in Morton order
  std::vector<Vec3> positions;
  std::vector<Index> place_of_point;
  for (std::size_t i = 0; i < places.position.size(); i += step) {
    positions.push_back(places.position[i]);
    place_of_point.push_back(static_cast<Index>(i));
  }
  std::optional<Vec3> from_origin;
  if (viewpoint) from_origin = *viewpoint - built.graph.origin;
  return {graph_from_points(positions, from_origin, {}, context), GeometryKind::Cloud, std::move(place_of_point)};
}

// Chosen points as indices of places.
std::vector<Index> choose(const Choosable& from, std::size_t count, const SampleOptions& options,
                          const RunContext& context) {
  const SurfaceGraph& graph = from.built.graph;
  std::size_t available = 0;
  for (std::size_t v = 0; v < graph.size(); ++v) {
    available += graph.outlier[v] == 0 && !(options.skip_boundary && graph.boundary[v] != 0);
  }
  SampleSize size;
  size.count = std::min(count, available);
  std::vector<Index> chosen;
  if (*size.count == 0) return chosen;
  const SampleResult sampled = sample_graph(from.built, from.kind, size, options, context);
  for (const Index point : sampled.indices) chosen.push_back(from.place_of_point[point]);
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

PreparedScan prepare_scan(const GeometryView& geometry, const RegisterOptions& options, std::string_view name,
                          const RunContext& context) {
  validate_options(options);
  BuiltGraph built = build_graph(geometry, {}, context.phase(0.0, 0.25, "build graph"));
  const Vec3 origin = built.graph.origin;
  Places places = places_of(built.graph);
  if (places.position.size() < kFewest) {
    throw FormatError(fmt::format("{}: {} distinct finite points that are no strays, expected {} or more to register",
                                  name, places.position.size(), kFewest));
  }
  const std::size_t count = sample_count(options, places.position.size());
  const Choosable from = choosable(std::move(built), geometry.kind(), places, std::max(kMostLookedAt, 4 * count),
                                   geometry.viewpoint, context.phase(0.25, 0.3, "thin out"));

  SampleOptions sampling = sample_preset(Preset::Detail);
  sampling.skip_boundary = options.skip_boundary;
  sampling.seed = options.seed;
  std::vector<Index> samples, keypoints;
  if (options.sampler == SamplingMethod::Shape) {  // a ranking: both are prefixes of it
    samples = choose(from, std::max(count, kKeypoints), sampling, context.phase(0.3, 0.9, "choose points"));
    keypoints.assign(samples.begin(), samples.begin() + std::ptrdiff_t(std::min(samples.size(), kKeypoints)));
    samples.resize(std::min(samples.size(), count));
  } else {
    if (options.coarse) {
      keypoints = choose(from, kKeypoints, sampling, context.phase(0.3, 0.7, "choose keypoints"));
    }
    sampling.method = options.sampler;
    samples = choose(from, count, sampling, context.phase(0.7, 0.9, "choose points"));
  }
  if (samples.size() < kFewest) {
    throw FormatError(fmt::format("{}: only {} points can be chosen, expected {} or more{}", name, samples.size(),
                                  kFewest,
                                  options.skip_boundary ? "; --no-skip-boundary allows those on its border" : ""));
  }
  const RunContext build = context.phase(0.9, 1.0, "build trees");
  RegistrationCloud thinned = subset(places, samples, build);
  RegistrationCloud full(std::move(places.position), std::move(places.normal), build);
  if (geometry.viewpoint) full.viewpoint = *geometry.viewpoint - origin;
  return {origin, std::move(full), std::move(thinned), std::move(keypoints)};
}

}  // namespace shapelight
