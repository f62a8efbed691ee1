#include "shapelight/metrics/sampling_quality.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight {
namespace {

void require_finite(std::span<const Vec3> points, const char* what) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw InvalidInput(fmt::format("{}: point {} is not finite", what, i));
  }
}

/// 1 for the ceil(n / 10) points of largest importance.
std::vector<std::uint8_t> feature_tenth(std::span<const double> importance) {
  std::vector<Index> order(importance.size());
  std::iota(order.begin(), order.end(), Index{0});
  const std::size_t count = (importance.size() + 9) / 10;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count - 1), order.end(),
                   [&](Index a, Index b) {
                     return importance[a] > importance[b] || (importance[a] == importance[b] && a < b);
                   });
  std::vector<std::uint8_t> feature(importance.size(), 0);
  for (std::size_t k = 0; k < count; ++k) feature[order[k]] = 1;
  return feature;
}

/// Distance from every query to the (rank + 1)-th nearest point of the tree.
std::vector<double> nearest_distances(const KdTree& tree, std::span<const Vec3> queries, std::size_t rank,
                                      const RunContext& context) {
  std::vector<double> distance(queries.size());
  parallel::for_chunks(context, queries.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> found;
    for (std::size_t i = begin; i < end; ++i) {
      tree.nearest(queries[i], rank + 1, found);
      distance[i] = std::sqrt(found.back().distance_sq);
    }
  });
  return distance;
}

struct MeanMax {
  double mean = 0.0;
  double max = 0.0;
};

/// Over the values with a mark, or over all if there are no marks.
MeanMax mean_and_max(std::span<const double> values, std::span<const std::uint8_t> marks) {
  MeanMax result;
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!marks.empty() && !marks[i]) continue;
    result.mean += values[i];
    result.max = std::max(result.max, values[i]);
    ++count;
  }
  result.mean /= static_cast<double>(count);
  return result;
}

void measure_features(std::span<const Vec3> reference, std::span<const double> importance,
                      std::span<const Vec3> samples, std::span<const double> coverage, const RunContext& context,
                      SamplingQuality& quality) {
  const std::vector<std::uint8_t> feature = feature_tenth(importance);
  const MeanMax feature_coverage = mean_and_max(coverage, feature);
  quality.feature_coverage_mean = feature_coverage.mean;
  quality.feature_coverage_max = feature_coverage.max;
  const KdTree tree(reference);
  quality.feature_share = parallel::sum(context, samples.size(), [&](std::size_t i) {
                            return static_cast<double>(feature[tree.nearest(samples[i]).index]);
                          }) / static_cast<double>(samples.size());
}

void measure_spacing(const KdTree& tree, std::span<const Vec3> samples, const RunContext& context,
                     SamplingQuality& quality) {
  const std::vector<double> spacing = nearest_distances(tree, samples, 1, context);
  quality.spacing_mean = mean_and_max(spacing, {}).mean;
  quality.spacing_min = *std::min_element(spacing.begin(), spacing.end());
  double variance = 0.0;
  for (const double s : spacing) variance += (s - quality.spacing_mean) * (s - quality.spacing_mean);
  variance /= static_cast<double>(spacing.size());
  quality.spacing_cv = quality.spacing_mean > 0.0 ? std::sqrt(variance) / quality.spacing_mean : 0.0;
}

}  // namespace

SamplingQuality measure_sampling(std::span<const Vec3> reference, std::span<const double> importance,
                                 std::span<const Vec3> samples, const RunContext& context) {
  if (reference.empty() || samples.empty()) {
    throw InvalidInput(fmt::format("sampling quality: {} reference points and {} samples, expected at least one of each",
                                   reference.size(), samples.size()));
  }
  if (!importance.empty() && importance.size() != reference.size()) {
    throw InvalidInput(fmt::format("sampling quality: {} importance values, expected {}, one per reference point",
                                   importance.size(), reference.size()));
  }
  require_finite(reference, "sampling quality: reference");
  require_finite(samples, "sampling quality: samples");
  for (std::size_t i = 0; i < importance.size(); ++i) {
    if (!std::isfinite(importance[i])) {
      throw InvalidInput(fmt::format("sampling quality: importance {} is {}, expected a finite number", i, importance[i]));
    }
  }
  SamplingQuality quality;
  const KdTree tree(samples);
  const std::vector<double> coverage = nearest_distances(tree, reference, 0, context);
  const MeanMax all = mean_and_max(coverage, {});
  quality.coverage_mean = all.mean;
  quality.coverage_max = all.max;
  if (!importance.empty()) measure_features(reference, importance, samples, coverage, context, quality);
  if (samples.size() > 1) measure_spacing(tree, samples, context, quality);
  return quality;
}

std::vector<double> surface_variation_knn(std::span<const Vec3> points, std::size_t k, const RunContext& context) {
  if (k < 3) throw InvalidInput(fmt::format("surface variation: k = {}, expected at least 3", k));
  require_finite(points, "surface variation");
  const KdTree tree(points);
  std::vector<double> variation(points.size());
  parallel::for_chunks(context, points.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> found;
    for (std::size_t i = begin; i < end; ++i) {
      tree.nearest(points[i], k, found);
      Vec3 mean = Vec3::Zero();  // relative to the point, so that a far origin costs no digits
      for (const Neighbor& neighbor : found) mean += points[neighbor.index] - points[i];
      mean /= static_cast<double>(found.size());
      Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
      for (const Neighbor& neighbor : found) {
        const Vec3 d = points[neighbor.index] - points[i] - mean;
        covariance += d * d.transpose();
      }
      const Vec3 lambda = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues();
      const double sum = lambda.sum();
      variation[i] = sum > 0.0 ? std::max(0.0, lambda[0]) / sum : 0.0;
    }
  });
  return variation;
}

}  // namespace shapelight
