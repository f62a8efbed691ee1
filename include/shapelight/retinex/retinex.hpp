#pragma once

#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Parameters of decompose_retinex().
struct RetinexOptions {
  double spatial_sigma = 3.0;  ///< [mean edge lengths] sigma_d of eq. 6
  double range_sigma = 0.15;   ///< [1] sigma_r of eq. 7, on intensities in [0, 1]
  int rings = 4;               ///< [rings] support of one bilateral mean
  int max_neighbors = 80;      ///< [points] at most so many, nearest rings first

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"retinex-sigma", "mean edge lengths", "Spatial width of the illumination.", 0.1, 30},
          o.spatial_sigma);
    visit(OptionInfo{"retinex-range-sigma", "1", "Difference of intensity that counts as an edge.", 1e-3, 100},
          o.range_sigma);
    visit(OptionInfo{"retinex-rings", "rings", "Support of one bilateral mean.", 1, 20}, o.rings);
    visit(OptionInfo{"retinex-neighbors", "points", "Largest number of vertices in one bilateral mean.", 2, 1000},
          o.max_neighbors);
  }
};

struct RetinexResult {
  std::vector<double> illumination;  ///< n: L in [0, 1], the smooth part
  std::vector<double> reflectance;   ///< n: R in [-log 2, log 2], the detail
};

/// Splits a field in [-1, 1], such as the shape index, into a smooth part and detail (eq. 4 to 8 of the paper).
///
/// Intensity I = (s + 1) / 2, since the logarithm needs I > -1. Illumination L: bilateral mean of I (eq. 4, 5), weight
/// area x exp(-|x - y|^2 / (2 sigma_d^2)) (eq. 6) x exp(-(I - I')^2 / (2 sigma_r^2)) (eq. 7). Reflectance
/// R = log(I + 1) - log(L + 1) (eq. 8).
///
/// A spatial_sigma above 3 does not fit into four rings: the mean is then repeated p = ceil((spatial_sigma / 3)^2)
/// times with sigma_d / sqrt(p), each pass on the last one's result, which gives the same spread at p times the cost.
/// Pre:   field.size() == graph.size(); values in [-1, 1].
/// Post:  sizes n; a constant field has reflectance 0, up to rounding.
/// Throws InvalidInput (names option or vertex), Cancelled.
/// Cost:  O(n max_neighbors) per pass; 40 n bytes beyond the result. Support: rings x p rings.
[[nodiscard]] RetinexResult decompose_retinex(const SurfaceGraph& graph, std::span<const double> field,
                                              const RetinexOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
