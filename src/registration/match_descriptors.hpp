#pragma once

#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/coarse_alignment.hpp"

namespace shapelight {

/// Points of two scans that look alike.
struct Match {
  Index source = kNoIndex;
  Index target = kNoIndex;
  bool turned = false;  ///< alike once the normals of one of them change their sign

  auto operator<=>(const Match&) const = default;
};

/// For every keypoint of either scan the two points of the other whose descriptors differ least; ascending, each once.
/// Unless both scans' normals are known to look to the same side, the other sign is tried as well.
/// Cost: keypoints x points x kBins multiplications, twice that for both signs.
[[nodiscard]] std::vector<Match> match_descriptors(const DescribedPoints& source, const DescribedPoints& target,
                                                   bool same_side, const RunContext& context);

}  // namespace shapelight
