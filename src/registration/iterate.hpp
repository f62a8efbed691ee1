#pragma once

#include <cstddef>
#include <optional>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

/// What one iteration found at the pose it was given, and the motion of the target frame that it asks for.
struct IterationStep {
  RigidTransform motion = RigidTransform::Identity();
  bool fixed_point = false;  ///< everything the motion depends on is as it was an iteration before
  double error = 0.0;        ///< the method's objective before the motion
  double inlier_ratio = 0.0;
  double rms = 0.0;
};

struct IterationLimits {
  int iterations = 0;
  double rotation = 0.0;     ///< [rad]
  double translation = 0.0;  ///< [length] of the source's origin, the middle of the scan
};

/// Throws InvalidInput unless both clouds hold `min_points` or more and the pose is a rigid motion of finite numbers.
void check_registration_input(const RegistrationCloud& source, const RegistrationCloud& target,
                              const RigidTransform& T_target_source, std::size_t min_points);

[[nodiscard]] double rotation_angle(const RigidTransform& motion);  ///< [rad]

/// The loop of every method: step(T_target_source) -> IterationStep, or nothing when too few pairs are left, until it
/// stands still. Goes on from `result`. True when it stood still.
template <class Step>
bool iterate(RegistrationResult& result, const IterationLimits& limits, const RunContext& context, Step&& step) {
  int percent = -1;
  result.stop = StopReason::IterationLimit;
  for (int i = 0; i < limits.iterations; ++i) {
    context.check();
    if (const int now = 100 * i / limits.iterations; now != percent) {
      percent = now;
      context.report(0.01 * percent);
    }
    const std::optional<IterationStep> found = step(result.T_target_source);
    if (!found) {
      result.stop = StopReason::TooFewPairs;
      return false;
    }
    ++result.iterations;
    result.error.push_back(found->error);
    result.inlier_ratio = found->inlier_ratio;
    result.rms = found->rms;
    if (found->fixed_point) {
      result.stop = StopReason::FixedPoint;
      return true;
    }
    const Vec3 before = result.T_target_source.translation();
    result.T_target_source = found->motion * result.T_target_source;
    if (rotation_angle(found->motion) <= limits.rotation &&
        (result.T_target_source.translation() - before).norm() <= limits.translation) {
      result.stop = StopReason::SmallStep;
      return true;
    }
  }
  return false;
}

}  // namespace shapelight
