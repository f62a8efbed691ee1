#pragma once

#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/coarse_alignment.hpp"

namespace shapelight {

/// Points of two scans that look alike.
struct Match {
  Index source = kNoIndex;
  Index target = kNoIndex;
  bool turned = false;    ///< alike when the target's normals change their sign
  float difference = 0;   ///< of the descriptors
};

std::vector<Match> match_descriptors(const DescribedPoints& source, const DescribedPoints& target, bool same_side,
                                     const RunContext& context);

}  // namespace shapelight
