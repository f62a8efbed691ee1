#pragma once

#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/pipeline/register.hpp"

namespace shapelight {

/// Between the scans' origins.
struct StartingPose {
  RigidTransform T_target_source = RigidTransform::Identity();
  /// From descriptors, good to a degree or two: FICP is not annealed from here, which would cost it scans that overlap
  /// by half only.
  bool is_close = false;
};

/// Where to look for a pose when none is known.
struct StartingPoses {
  /// Of the coarse alignment, best supported first, and that of the files, since many scans come roughly in place.
  std::vector<StartingPose> poses;
  /// Motions after which the source looks much like itself, as a cube does: every pose has a rival for each of them.
  std::vector<RigidTransform> T_source_source;
};
[[nodiscard]] StartingPoses find_starting_poses(const PreparedScan& source, const PreparedScan& target,
                                                const RunContext& context);

/// How well a pose fits on the samples, in [0, 1]: each counts 1 - (d / reach)^2 when the other scan's surface is
/// within reach (1 % of the smaller diagonal) and faces the same way; of the scan that fits better.
[[nodiscard]] double fit_of_samples(const PreparedScan& source, const PreparedScan& target,
                                    const RigidTransform& T_target_source, const RunContext& context);

/// Do two poses put the source at places that differ by less than 10 degrees and 5 % of its diagonal?
[[nodiscard]] bool are_alike(const RigidTransform& a, const RigidTransform& b, double diagonal);

}  // namespace shapelight
