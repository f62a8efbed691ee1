#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

/// Points of a scan that can be recognised in another one.
struct DescribedPoints {
  static constexpr std::size_t kBins = 33;  ///< values of one descriptor

  std::vector<Vec3> position;           ///< k: [input length unit]
  std::vector<Vec3> normal;             ///< k: unit
  std::vector<float> descriptor;        ///< k x kBins, row by row
  bool normals_look_at_sensor = false;  ///< else their common sign is arbitrary, and both signs are tried

  [[nodiscard]] std::size_t size() const { return position.size(); }
};

/// Fast point feature histograms (Rusu, Blodow and Beetz 2009) of `keypoints` (indices into the cloud), over the points
/// of the cloud within `radius`. Points without a normal, and keypoints without neighbours, are left out.
/// Pre: the cloud has normals; radius > 0 (InvalidInput). Cost: O(points within two radii of a keypoint).
[[nodiscard]] DescribedPoints describe_points(const RegistrationCloud& cloud, std::span<const Index> keypoints,
                                              double radius, const RunContext& context = {});

/// Parameters of align_coarsely().
struct CoarseAlignmentOptions {
  double tolerance = 0.0;  ///< [input length unit] matches agree when distances between them differ by less; > 0
  int max_hypotheses = 8;  ///< [poses] returned at most

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(
        OptionInfo{"tolerance", "input length unit", "How exactly the distances between matches must agree.", 0, 1e300},
        o.tolerance);
    visit(OptionInfo{"max-hypotheses", "poses", "Distinct poses to return at most.", 1, 64}, o.max_hypotheses);
  }
};

/// A guess of where the source lies, and how much speaks for it.
struct PoseHypothesis {
  RigidTransform T_target_source = RigidTransform::Identity();
  double support = 0.0;  ///< [matches] that agree with it
};

/// Poses that bring described points onto each other, without any starting guess: descriptors are matched, matches that
/// keep each other's distances vote for each other (second-order spatial compatibility, Chen et al. 2022), and the
/// best supported groups each give a pose. Most support first, no two alike; empty when nothing agrees.
/// Throws InvalidInput, Cancelled.
[[nodiscard]] std::vector<PoseHypothesis> align_coarsely(const DescribedPoints& source, const DescribedPoints& target,
                                                         const CoarseAlignmentOptions& options,
                                                         const RunContext& context = {});

}  // namespace shapelight
