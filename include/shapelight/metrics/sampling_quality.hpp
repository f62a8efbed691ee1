#pragma once

#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight {

/// How well a sample stands for its reference points. Lengths in [input length unit].
struct SamplingQuality {
  double coverage_max = 0.0;           ///< largest distance from a reference point to its nearest sample
  double coverage_mean = 0.0;          ///< mean of those distances
  double feature_coverage_mean = 0.0;  ///< the same over the tenth of the reference with the largest importance
  double feature_coverage_max = 0.0;
  double feature_share = 0.0;  ///< [1] share of samples whose nearest reference point is in that tenth
  double spacing_mean = 0.0;   ///< mean distance from a sample to the nearest other one
  double spacing_min = 0.0;    ///< smallest of those distances
  double spacing_cv = 0.0;     ///< [1] their standard deviation by their mean; 0 is a perfect lattice
};

/// Measures a sample against its reference points, exactly.
/// The feature tenth is the ceil(n / 10) points of largest importance, ties by index; without importance the feature
/// figures are 0. The spacing figures of a single sample are 0.
/// Pre:    importance is empty or as long as reference.
/// Throws: InvalidInput (empty, of unequal length, or not finite: names the index), Cancelled.
/// Cost:   O((n + m) log m).
[[nodiscard]] SamplingQuality measure_sampling(std::span<const Vec3> reference, std::span<const double> importance,
                                               std::span<const Vec3> samples, const RunContext& context = {});

/// Surface variation (Pauly, Gross and Kobbelt 2002): l0 / (l0 + l1 + l2) of the covariance of the k nearest points,
/// the point itself included; 0 in a plane, at most 1/3. Needs neither mesh nor normals, so it is the definition of
/// "feature" that no sampler here is built on alone.
/// Pre:    k >= 3; fewer than k points use all.
/// Throws: InvalidInput (k, or a point that is not finite), Cancelled.
/// Cost:   O(n k log n).
[[nodiscard]] std::vector<double> surface_variation_knn(std::span<const Vec3> points, std::size_t k = 30,
                                                        const RunContext& context = {});

}  // namespace shapelight
