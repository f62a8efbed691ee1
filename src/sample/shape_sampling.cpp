#include "shapelight/sample/shape_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "sample/candidates.hpp"
#include "sample/farthest_tree.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

constexpr double kDensityFloor = 0.15;
constexpr double kDensityCap = 6.0;
// The variation's share and exponent were chosen by measurement (docs/sampling.md): against equal halves of both as
// they are, the most curved tenth is covered at 0.85 of the distance at the same largest gap.
constexpr double kVariationShare = 0.7;
constexpr double kVariationExponent = 1.5;
constexpr int kCapRounds = 6;  // capping moves the mean; after six rounds both have settled
constexpr std::size_t kPicksPerPoll = 256;

void check_size(const SurfaceGraph& graph, std::span<const double> field, const char* name, bool may_be_empty) {
  if (field.size() == graph.size() || (may_be_empty && field.empty())) return;
  throw InvalidInput(fmt::format("{}: {} values for {} vertices", name, field.size(), graph.size()));
}

double finite_or_zero(double value) { return std::isfinite(value) ? value : 0.0; }

// Scales to an area mean of 1 with values capped at kDensityCap means. Area, not vertex, means: a graded tessellation
// must not shift the balance.
void normalise(const SurfaceGraph& graph, std::vector<double>& values, const RunContext& context) {
  const std::size_t n = graph.size();
  const auto divide_by_mean = [&](double cap) {
    const double mean = parallel::sum(context, n, [&](std::size_t i) { return graph.area[i] * values[i]; }) /
                        std::max(graph.total_area, std::numeric_limits<double>::min());
    if (!(mean > 0.0)) return;
    for (double& v : values) v = std::min(v / mean, cap);
  };
  for (int round = 0; round < kCapRounds; ++round) divide_by_mean(kDensityCap);
  divide_by_mean(std::numeric_limits<double>::infinity());
}

std::vector<double> curvature_term(const SurfaceGraph& graph, const ShapeFields& fields, const RunContext& context) {
  const std::size_t n = graph.size();
  std::vector<double> raw(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double curvedness = finite_or_zero(fields.curvedness[i]);
    raw[i] = curvedness * curvedness;
    if (!fields.shape_index.empty()) raw[i] *= 0.5 + std::abs(finite_or_zero(fields.shape_index[i]));
    if (!fields.reflectance.empty()) raw[i] *= 1.0 + 4.0 * std::abs(finite_or_zero(fields.reflectance[i]));
  }
  std::vector<double> mean(n);
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double sum = graph.area[i] * raw[i];
      double area = graph.area[i];
      for (const Index j : graph.neighbors_of(i)) {
        sum += graph.area[j] * raw[j];
        area += graph.area[j];
      }
      mean[i] = area > 0.0 ? sum / area : 0.0;
    }
  });
  return mean;
}

std::vector<double> variation_term(const ShapeFields& fields) {
  std::vector<double> values(fields.surface_variation.begin(), fields.surface_variation.end());
  for (double& v : values) v = finite_or_zero(v);
  if (fields.noisy && !values.empty()) {
    std::vector<double> sorted = values;
    const auto tenth = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10);
    std::nth_element(sorted.begin(), tenth, sorted.end());
    const double floor = *tenth;
    for (double& v : values) v = std::max(0.0, v - floor);
  }
  for (double& v : values) v = std::pow(v, kVariationExponent);
  return values;
}

// The first pick: the largest w d^2, d being the distance to the centroid. The largest w alone would not do: many
// points have the capped one, and the order of the vertices, which changes with a rotation, would choose among them.
Index first_pick(std::span<const Vec3> points, std::span<const double> weights) {
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : points) centroid += p;
  centroid /= static_cast<double>(points.size());
  const auto score = [&](Index i) {
    return (weights.empty() ? 1.0 : weights[i]) * (points[i] - centroid).squaredNorm();
  };
  Index best = 0;
  for (Index i = 1; i < points.size(); ++i) {
    if (score(i) > score(best)) best = i;
  }
  return best;
}

// Ranks the points; stops after target.count picks, or when no point is farther than target.spacing from a pick.
std::vector<Index> rank(std::span<const Vec3> points, std::span<const double> weights, double local_share,
                        const SamplingTarget& target, const RunContext& context) {
  const std::size_t limit = target.count > 0 ? target.count : points.size();
  const double stop_sq = target.spacing * target.spacing;
  const Index first = first_pick(points, local_share > 0.0 ? weights : std::span<const double>{});
  FarthestTree tree(points, weights, context);
  std::vector<Index> picks;
  picks.reserve(target.count);
  std::size_t num_local = 0;
  while (picks.size() < limit) {
    if (picks.size() % kPicksPerPoll == 0) {
      context.report(static_cast<double>(picks.size()) / static_cast<double>(limit));
    }
    context.check();  // each time: the first picks bring all points closer
    const bool local = static_cast<double>(num_local) < local_share * static_cast<double>(picks.size() + 1);
    num_local += local;
    // A local pick of no weight left would repeat a chosen point.
    const bool by_weight = local && tree.weighted_farthest_sq() > 0.0;
    const Index pick = picks.empty() ? first : by_weight ? tree.weighted_farthest() : tree.farthest();
    if (!picks.empty() && target.spacing > 0.0 && tree.farthest_sq() <= stop_sq) break;
    picks.push_back(pick);
    tree.choose(pick);
  }
  context.report(1.0);
  return picks;
}

std::vector<Vec3> positions_of(const SurfaceGraph& graph, std::span<const Index> candidates) {
  std::vector<Vec3> points(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) points[i] = graph.position[candidates[i]];
  return points;
}

void to_vertices(std::vector<Index>& picks, std::span<const Index> candidates) {
  for (Index& pick : picks) pick = candidates[pick];
}

}  // namespace

std::vector<double> sampling_density(const SurfaceGraph& graph, const ShapeFields& fields, const RunContext& context) {
  check_size(graph, fields.curvedness, "curvedness", false);
  check_size(graph, fields.surface_variation, "surface variation", false);
  check_size(graph, fields.shape_index, "shape index", true);
  check_size(graph, fields.reflectance, "reflectance", true);
  std::vector<double> density = curvature_term(graph, fields, context);
  std::vector<double> variation = variation_term(fields);
  normalise(graph, density, context);
  normalise(graph, variation, context);
  for (std::size_t i = 0; i < density.size(); ++i) {
    const double wanted = (1.0 - kVariationShare) * density[i] + kVariationShare * variation[i];
    const bool on_surface = !graph.outlier[i] && !graph.neighbors_of(i).empty();
    density[i] = on_surface ? std::max(kDensityFloor, wanted) : 0.0;
  }
  return density;
}

std::vector<Index> sample_by_shape(const SurfaceGraph& graph, std::span<const Index> candidates,
                                   std::span<const double> density, const SamplingTarget& target,
                                   const ShapeSamplingOptions& options, const RunContext& context) {
  validate_options(options);
  check_sampling(graph, candidates, target);
  check_size(graph, density, "density", false);
  std::vector<double> weights(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    weights[i] = density[candidates[i]];
    if (!(weights[i] >= 0.0 && std::isfinite(weights[i]))) {
      throw InvalidInput(
          fmt::format("density of vertex {}: {} is not a finite number >= 0", candidates[i], weights[i]));
    }
  }
  std::vector<Index> picks = rank(positions_of(graph, candidates), weights, options.local_weight, target, context);
  to_vertices(picks, candidates);
  return picks;
}

std::vector<Index> sample_farthest(const SurfaceGraph& graph, std::span<const Index> candidates,
                                   const SamplingTarget& target, const RunContext& context) {
  check_sampling(graph, candidates, target);
  std::vector<Index> picks = rank(positions_of(graph, candidates), {}, 0.0, target, context);
  to_vertices(picks, candidates);
  return picks;
}

}  // namespace shapelight
