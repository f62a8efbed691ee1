#include "shapelight/metrics/surface_distance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "core/parallel.hpp"
#include "metrics/surface_samples.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/data/geometry.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kLeastSamples = 100000;
constexpr std::size_t kSamplesPerVertex = 10;
constexpr std::uint64_t kStreamsPerSurface = 3;
constexpr float kNoAngle = -1.0f;
constexpr std::array<std::string_view, 2> kNames = {"reference", "test"};

// One of the two surfaces, moved to the origin, so that samples keep their digits at a far offset.
struct Surface {
  TriangleMesh mesh;
  TriangleTree tree;
  std::vector<Index> vertices;  // those of a triangle
};

Surface prepare(const MeshView& original, const Vec3& origin, std::string_view name, const RunContext& context) {
  Surface surface{
      {{original.positions.begin(), original.positions.end()}, {original.triangles.begin(), original.triangles.end()}},
      {},
      {}};
  for (Vec3& p : surface.mesh.positions) p -= origin;
  try {
    surface.tree = TriangleTree(surface.mesh, context);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("surface distance: {}: {}", name, error.what()));
  }
  std::vector<std::uint8_t> used(surface.mesh.positions.size(), 0);
  for (const Triangle& t : surface.mesh.triangles) {
    for (const Index v : t) used[v] = 1;
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) surface.vertices.push_back(static_cast<Index>(v));
  }
  return surface;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

struct Totals {
  double sum = 0.0;
  double sum_sq = 0.0;
  double max = 0.0;
  static Totals join(const Totals& a, const Totals& b) {
    return {a.sum + b.sum, a.sum_sq + b.sum_sq, std::max(a.max, b.max)};
  }
};

// Distances of the samples; their angles too, kNoAngle where there is none.
Totals measure_samples(const Surface& from, const Surface& to, const SurfaceSamples& samples, std::span<float> angles,
                       const RunContext& context) {
  const auto chunk = [&](std::size_t begin, std::size_t end) {
    Totals totals;
    Index at = samples.triangle_before(begin), near = kNoIndex;
    for (std::size_t k = begin; k < end; ++k) {
      const SurfaceSamples::Sample sample = samples.at(k, at);
      const TriangleTree::Hit hit = to.tree.closest(sample.point, near);
      at = sample.triangle;
      near = hit.triangle;
      totals.sum += std::sqrt(hit.distance_sq);
      totals.sum_sq += hit.distance_sq;
      totals.max = std::max(totals.max, hit.distance_sq);
      const Vec3 own = area_normal(from.mesh, sample.triangle), other = area_normal(to.mesh, hit.triangle);
      const bool known = own.squaredNorm() > 0.0 && other.squaredNorm() > 0.0;
      angles[k] = known ? static_cast<float>(angle_between(own, other)) : kNoAngle;
    }
    return totals;
  };
  return parallel::reduce_chunks(context, samples.size(), Totals{}, chunk, Totals::join);
}

Totals measure_vertices(const Surface& from, const Surface& to, const RunContext& context) {
  const auto chunk = [&](std::size_t begin, std::size_t end) {
    Totals totals;
    Index near = kNoIndex;
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleTree::Hit hit = to.tree.closest(from.mesh.positions[from.vertices[i]], near);
      near = hit.triangle;
      totals.sum_sq += hit.distance_sq;
      totals.max = std::max(totals.max, hit.distance_sq);
    }
    return totals;
  };
  return parallel::reduce_chunks(context, from.vertices.size(), Totals{}, chunk, Totals::join);
}

struct OneSided {
  DistanceSummary distance;
  double vertex_rms = 0.0;
};

// `side`, 0 or 1, keeps the random numbers and the angles of the two directions apart.
OneSided measure_direction(const Surface& from, const Surface& to, std::uint64_t seed, std::size_t side,
                           std::span<float> both_angles, const RunContext& context) {
  const std::size_t count = both_angles.size() / 2;
  const SurfaceSamples samples(from.mesh, count, seed, kStreamsPerSurface * side);
  if (!(samples.area() > 0.0)) {
    throw InvalidInput(fmt::format("surface distance: {}: the area is 0, expected a surface", kNames[side]));
  }
  const Totals inner = measure_samples(from, to, samples, both_angles.subspan(side * count, count), context);
  const Totals vertices = measure_vertices(from, to, context);
  const auto weight = 1.0 / static_cast<double>(count);
  return {{inner.sum * weight, std::sqrt(inner.sum_sq * weight), std::sqrt(std::max(inner.max, vertices.max))},
          std::sqrt(vertices.sum_sq / static_cast<double>(from.vertices.size()))};
}

NormalDeviation summarize(std::vector<float>& angles) {
  angles.erase(std::remove(angles.begin(), angles.end(), kNoAngle), angles.end());
  if (angles.empty()) return {};
  double sum_sq = 0.0;
  for (const float angle : angles) sum_sq += static_cast<double>(angle) * static_cast<double>(angle);
  const auto at = angles.begin() + static_cast<std::ptrdiff_t>((angles.size() - 1) * 95 / 100);
  std::nth_element(angles.begin(), at, angles.end());
  return {std::sqrt(sum_sq / static_cast<double>(angles.size())), static_cast<double>(*at)};
}

}  // namespace

SurfaceDistance measure_surface_distance(const MeshView& reference, const MeshView& test,
                                         const SurfaceDistanceOptions& options, const RunContext& context) {
  validate_options(options);
  const BoundingBox box = bounding_box(reference.positions);
  const RunContext building = context.phase(0.0, 0.1, "surface trees");
  const Surface from = prepare(reference, box.center(), kNames[0], building);
  const Surface to = prepare(test, box.center(), kNames[1], building);

  SurfaceDistance result;
  result.diagonal = box.diagonal();
  result.samples = options.samples;
  if (result.samples == 0) {
    result.samples = std::max(kLeastSamples, kSamplesPerVertex * std::max(from.vertices.size(), to.vertices.size()));
  }
  std::vector<float> angles(2 * result.samples);
  const OneSided forward =
      measure_direction(from, to, options.seed, 0, angles, context.phase(0.1, 0.55, "forward distances"));
  const OneSided backward =
      measure_direction(to, from, options.seed, 1, angles, context.phase(0.55, 1.0, "backward distances"));
  const DistanceSummary &f = forward.distance, &b = backward.distance;
  result.forward = f;
  result.backward = b;
  result.symmetric = {0.5 * (f.mean + b.mean), std::sqrt(0.5 * (f.rms * f.rms + b.rms * b.rms)),
                      std::max(f.max, b.max)};
  result.vertex_rms = forward.vertex_rms;
  result.normal_deviation = summarize(angles);
  context.report(1.0);
  return result;
}

std::vector<double> vertex_distances(const MeshView& mesh, const TriangleTree& surface, const RunContext& context) {
  std::vector<double> distances(mesh.positions.size());
  parallel::for_chunks(context, distances.size(), [&](std::size_t begin, std::size_t end) {
    Index near = kNoIndex;
    for (std::size_t v = begin; v < end; ++v) {
      const TriangleTree::Hit hit = surface.closest(mesh.positions[v], near);
      near = hit.triangle;
      distances[v] = std::sqrt(hit.distance_sq);
    }
  });
  return distances;
}

}  // namespace shapelight
