#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "shapelight/core/types.hpp"

namespace shapelight {

/// Why an iteration ended.
enum class StopReason : std::uint8_t {
  FixedPoint,      ///< the correspondences repeat: nothing can change any more
  SmallStep,       ///< the step fell below the tolerances
  IterationLimit,  ///< still moving after the last iteration that was allowed
  TooFewPairs,     ///< too few correspondences to determine a motion: the pose is that of the iteration before
};
[[nodiscard]] std::string_view stop_reason_name(StopReason stop);  ///< "fixed point", "small step", ...

/// How a registration ended. One iteration's error is the method's own objective before that iteration's step.
struct RegistrationResult {
  RigidTransform T_target_source = RigidTransform::Identity();
  StopReason stop = StopReason::IterationLimit;
  std::size_t iterations = 0;
  double inlier_ratio = 0.0;  ///< [1] share of the source points that had a say in the last step
  double rms = 0.0;           ///< [input length unit] point-to-point, over those
  std::vector<double> error;  ///< per iteration

  [[nodiscard]] bool converged() const { return stop == StopReason::FixedPoint || stop == StopReason::SmallStep; }
};

}  // namespace shapelight
