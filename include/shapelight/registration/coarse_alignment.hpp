#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

/// A scan at even density, every point with a description of the surface around it.
struct DescribedPoints {
  static constexpr std::size_t kBins = 33;  ///< values of one descriptor

  double spacing = 0.0;           ///< [input length unit] of the points below, about
  std::vector<Vec3> position;     ///< n: [input length unit]
  std::vector<Vec3> normal;       ///< n: unit
  std::vector<float> descriptor;  ///< n x kBins, row by row
  std::vector<Index> keypoints;   ///< of the n: those worth recognising, best first

  [[nodiscard]] std::size_t size() const { return position.size(); }
};

[[nodiscard]] double coarse_spacing(const RegistrationCloud& cloud);

[[nodiscard]] DescribedPoints describe_points(const RegistrationCloud& cloud, std::span<const Index> keypoints,
                                              double spacing, const RunContext& context = {});

/// Parameters of align_coarsely().
struct CoarseAlignmentOptions {
  bool same_side = false;  ///< both scans' normals look at their sensor; else a surface may come with either sign
  int max_hypotheses = 8;  ///< [poses] returned at most

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"same-side", "", "The normals of both scans look at their sensor.", 0, 0}, o.same_side);
    visit(OptionInfo{"max-hypotheses", "poses", "Distinct poses to return at most.", 1, 64}, o.max_hypotheses);
  }
};

/// A guess of where the source lies, and how much speaks for it.
struct PoseHypothesis {
  RigidTransform T_target_source = RigidTransform::Identity();
  double support = 0.0;  ///< [1] share of ...
};

[[nodiscard]] std::vector<PoseHypothesis> align_coarsely(const DescribedPoints& source, const DescribedPoints& target,
                                                         const CoarseAlignmentOptions& options,
                                                         const RunContext& context = {});

}  // namespace shapelight
