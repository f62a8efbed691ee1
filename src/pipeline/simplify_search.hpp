#pragma once

#include <cstddef>
#include <functional>

namespace shapelight::pipeline {

/// What the search looks at: count -> error. May throw TargetUnreachable when so few cannot be reached.
using ErrorOfCount = std::function<double(std::size_t)>;

struct CountSearch {
  std::size_t least = 4;      ///< the coarsest count worth trying
  std::size_t most = 0;       ///< the finest count: the input's
  std::size_t guess = 0;      ///< where to start
  std::size_t max_tries = 8;  ///< evaluations before the finest count is the last resort
  double precision = 0.02;    ///< the count found is within this share of the coarsest
};

struct FoundCount {
  std::size_t count = 0;
  double error = 0.0;
  std::size_t tries = 0;
};

/// The smallest count whose error is at most `bound`, for an error that falls with the count about as a power of it.
/// Brackets from the guess, then takes secants on logarithmic scales, kept inside the bracket's middle.
/// Throws TargetUnreachable when even `most` is above the bound; it says how far that got.
[[nodiscard]] FoundCount find_count(double bound, const CountSearch& search, const ErrorOfCount& error_of);

}  // namespace shapelight::pipeline
