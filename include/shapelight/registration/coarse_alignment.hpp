#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/registration/registration_cloud.hpp"

namespace shapelight {

/// A scan at even density, every point with a description of the surface around it.
struct DescribedPoints {
  static constexpr std::size_t kBins = 33;  ///< values of one descriptor

  double spacing = 0.0;           ///< [input length unit] between the points, about
  std::vector<Vec3> position;     ///< n: [input length unit]
  std::vector<Vec3> normal;       ///< n: unit
  std::vector<float> descriptor;  ///< n x kBins, row by row; all zero for a point without neighbours
  std::vector<Index> keypoints;   ///< of the n: those worth recognising, best first

  [[nodiscard]] std::size_t size() const { return position.size(); }
};

/// The spacing at which a scan should be described: about 4000 points are left, and never less than twice its own
/// spacing, so that noise averages out. Scans that are to be aligned with each other share one spacing: the largest of
/// theirs. 0 when the cloud has fewer than two places: there is nothing to describe. Cost: O(n), well below describing.
[[nodiscard]] double coarse_spacing(const RegistrationCloud& cloud);

/// Thins a scan to `spacing` (the mean of the points, and of the normals, in every cubic cell) and describes every
/// point by its fast point feature histogram (Rusu, Blodow and Beetz 2009) over the points within five spacings.
/// `keypoints` index the cloud, best first; those that fall into one cell are one, and the first 600 are kept. Choose
/// points on detail, off the border: on planes everything looks alike. Normals need consistent signs within a
/// neighbourhood only. Points without a normal are left out.
/// Throws InvalidInput (no normals, spacing not positive or below a millionth of the diagonal, keypoint out of range),
/// Cancelled. Cost: O(n log n) to thin, then 4000 points x 80 neighbours: about 0.05 s.
[[nodiscard]] DescribedPoints describe_points(const RegistrationCloud& cloud, std::span<const Index> keypoints,
                                              double spacing, const RunContext& context = {});

/// Parameters of align_coarsely().
struct CoarseAlignmentOptions {
  bool same_side = false;  ///< normals of both scans look at their sensors; else matches may turn the surface over
  int max_hypotheses = 8;  ///< [poses] returned at most

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"same-side", "", "The normals of both scans look at their sensors.", 0, 0}, o.same_side);
    visit(OptionInfo{"max-hypotheses", "poses", "Distinct poses to return at most.", 1, 64}, o.max_hypotheses);
  }
};

/// A guess of where the source lies, and how much speaks for it.
struct PoseHypothesis {
  RigidTransform T_target_source = RigidTransform::Identity();
  double support = 0.0;  ///< [matches] that agree with it; on real pairs wrong poses had 8 to 22, right ones over 29
};

/// Poses that bring two described scans onto each other, without any starting guess. Every keypoint of either scan is
/// matched with the points of the other that look most like it; matches that keep each other's distances and angles
/// vote for each other, counted over common friends (second-order spatial compatibility, Chen et al. 2022); each of
/// those with most votes, with its closest friends, gives a pose, which is fitted again to all matches that agree with
/// it. Most support first, no two alike; empty when nothing agrees. A pose is good to about one spacing and a degree or
/// two: the start of a registration, not its result. Rigid, at scale one.
/// Throws InvalidInput (options), Cancelled. Same result for any RunContext. Cost: at most 2400^2 pairs of matches,
/// about 0.1 s and 1 MB.
[[nodiscard]] std::vector<PoseHypothesis> align_coarsely(const DescribedPoints& source, const DescribedPoints& target,
                                                         const CoarseAlignmentOptions& options = {},
                                                         const RunContext& context = {});

}  // namespace shapelight
