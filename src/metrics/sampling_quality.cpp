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
  std::nth_element(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count - 1), order.end(),
      [&](Index a, Index b) { return importance[a] > importance[b] || (importance[a] == importance[b] && a < b); });
  std::vector<std::uint8_t> feature(importance.size(), 0);
  for (std::size_t k = 0; k < count; ++k) feature[order[k]] = 1;
  return feature;
}

std::vector<double> nearest_distances(const KdTree& tree, std::span<const Vec3> queries, const RunContext& context) {
  std::vector<double> distance(queries.size());
  parallel::for_chunks(context, queries.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) distance[i] = std::sqrt(tree.nearest(queries[i]).distance_sq);
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
  const KdTree tree(reference, context);
  quality.feature_share =
      parallel::sum(context, samples.size(),
                    [&](std::size_t i) { return static_cast<double>(feature[tree.nearest(samples[i]).index]); }) /
      static_cast<double>(samples.size());
}

void measure_spacing(const KdTree& tree, std::span<const Vec3> samples, const RunContext& context,
                     SamplingQuality& quality) {
  const std::vector<Index> nearest = tree.all_nearest(1, context);
  std::vector<double> spacing(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) spacing[i] = (samples[i] - samples[nearest[i]]).norm();
  quality.spacing_mean = mean_and_max(spacing, {}).mean;
  quality.spacing_min = *std::min_element(spacing.begin(), spacing.end());
  double variance = 0.0;
  for (const double s : spacing) variance += (s - quality.spacing_mean) * (s - quality.spacing_mean);
  variance /= static_cast<double>(spacing.size());
  quality.spacing_cv = quality.spacing_mean > 0.0 ? std::sqrt(variance) / quality.spacing_mean : 0.0;
}

double surface_variation(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) covariance += (p - mean) * (p - mean).transpose();
  const Vec3 lambda = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues();
  const double sum = lambda.sum();
  return sum > 0.0 ? std::max(0.0, lambda[0]) / sum : 0.0;
}

}  // namespace

SamplingQuality measure_sampling(std::span<const Vec3> reference, std::span<const double> importance,
                                 std::span<const Vec3> samples, const RunContext& context) {
  if (reference.empty() || samples.empty()) {
    throw InvalidInput(
        fmt::format("sampling quality: {} reference points and {} samples, expected at least one of each",
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
      throw InvalidInput(
          fmt::format("sampling quality: importance {} is {}, expected a finite number", i, importance[i]));
    }
  }
  SamplingQuality quality;
  const KdTree tree(samples, context);
  const std::vector<double> coverage = nearest_distances(tree, reference, context);
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
  const std::vector<Index> nearest = KdTree(points, context).all_nearest(k - 1, context);
  std::vector<double> variation(points.size());
  parallel::for_chunks(context, points.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> offsets;  // from the point itself, so that a far origin costs no digits
    for (std::size_t i = begin; i < end; ++i) {
      offsets.assign(1, Vec3::Zero());
      for (std::size_t j = i * (k - 1); j < (i + 1) * (k - 1) && nearest[j] != kNoIndex; ++j) {
        offsets.push_back(points[nearest[j]] - points[i]);
      }
      variation[i] = surface_variation(offsets);
    }
  });
  return variation;
}

}  // namespace shapelight
