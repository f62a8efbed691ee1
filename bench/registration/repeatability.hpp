#pragma once

#include <span>

#include "scan_pairs.hpp"

namespace shapelight::bench {

/// Do two samplings of a pair keep the same places? Shares, at the true pose. Spacing of samples: eq = point spacing /
/// sqrt(share kept), of the target.
struct Repeatability {
  double no_counterpart = 0.0;  ///< source samples with no target point within 3 point spacings
  double hit = 0.0;             ///< of the others: a target sample within eq / 2
  double chance = 0.0;          ///< hit, were each target sample a random target point within 1.5 eq of it
  double close_hit = 0.0;       ///< of the others: a target sample within one point spacing
  double mutual = 0.0;          ///< of the others: hit, and each other's nearest sample
  double boundary = 0.0;        ///< source samples on the border
};

/// `source` and `target`: the samples, as indices of prepared.full, which prepared.samples hold in the same order.
[[nodiscard]] Repeatability measure_repeatability(const Pair& pair, std::span<const Index> source,
                                                  std::span<const Index> target);

}  // namespace shapelight::bench
