#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/pipeline/register.hpp"
#include "shapelight/registration/pose_graph.hpp"

namespace shapelight {

/// What align_scans() does.
struct AlignOptions {
  RegisterOptions registration;  ///< of each pair
  double min_confidence = 0.5;   ///< [1] pairs that are less sure are not used
  bool sequence = false;  ///< scans come in order: only neighbours are tried, then pairs that turn out to overlap
  std::size_t max_all_pairs = 30;  ///< [scans] up to so many, every pair is tried; beyond, as with `sequence`
  double min_overlap = 0.1;        ///< [1] placed scans that share so much are registered, closing loops
  bool refine = true;              ///< at the end, all scans move at once until their surfaces lie on each other

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    RegisterOptions::describe(o.registration, visit);
    visit(OptionInfo{"min-confidence", "1", "Pairs that are less sure are not used.", 0, 1}, o.min_confidence);
    visit(OptionInfo{"sequence", "", "The scans come in order: try neighbours, then what turns out to overlap.", 0, 1},
          o.sequence);
    visit(OptionInfo{"max-all-pairs", "scans", "Up to so many scans every pair is tried.", 2, 1000}, o.max_all_pairs);
    visit(OptionInfo{"min-overlap", "1", "Placed scans that share so much are registered, closing loops.", 0.01, 1},
          o.min_overlap);
    visit(OptionInfo{"refine", "", "At the end, move all scans at once.", 0, 1}, o.refine);
  }
};

/// A pair of scans that was registered.
struct AlignedPair {
  std::size_t target = 0;
  std::size_t source = 0;
  RigidTransform T_target_source = RigidTransform::Identity();  ///< as registered, input frames
  double registration_confidence = 0.0;                         ///< [1] of the registration by itself
  double overlap = 0.0;                                         ///< [1] share of the smaller scan, as registered
  bool closes_loop = false;  ///< tried because placed scans overlap, starting from their poses
  PoseGraphEdgeResult
      graph;                ///< used or dropped and why; confidence after the loops; disagreement with the final poses
  double rms_before = 0.0;  ///< [input length unit] point to plane, both ways, as registered ...
  double rms_after = 0.0;   ///< ... and with the final poses; 0 where the scans are in different groups
};

struct AlignedScan {
  RigidTransform T_world_scan = RigidTransform::Identity();  ///< input frames; within the scan's group only
  std::size_t group = 0;                                     ///< 0 is the largest
  std::vector<std::size_t> partners;                         ///< scans that it overlaps, ascending
  double rms = 0.0;  ///< [input length unit] point to plane, over its overlaps; 0 without a partner
};

struct AlignResult {
  std::vector<AlignedScan> scans;
  std::vector<AlignedPair> pairs;  ///< every pair tried, by target and source
  std::size_t num_groups = 0;
  std::size_t num_placed = 0;  ///< scans in group 0
  double chi_sq_before = 0.0;  ///< of the used pairs at the spanning tree's poses, and ...
  double chi_sq_after = 0.0;   ///< ... at those of the pose graph
  std::vector<std::string> warnings;

  [[nodiscard]] bool all_placed() const { return num_placed == scans.size(); }
};

/// Brings many scans into one frame, without starting guesses: registers pairs, checks their loops, finds the poses
/// that the right pairs agree on (optimize_pose_graph), registers placed pairs that turn out to overlap, and moves all
/// scans at once until their surfaces lie on each other (refine_jointly). The world is the input frame of the first
/// scan of the largest group. A scan that nothing sure connects is never placed: it has a group of its own.
/// Pre: at least two scans, each with enough points to register. Throws InvalidInput (names the scan), Cancelled.
/// Same result for any RunContext. Cost: a registration per pair tried; all scans are held in memory.
[[nodiscard]] AlignResult align_scans(std::span<const GeometryView> scans, const AlignOptions& options = {},
                                      const RunContext& context = {});

/// All finite points of the placed scans (group 0) in the world frame, scan after scan, as one cloud: with the
/// attributes that all of these scans have, and `scan`, the index of the scan.
[[nodiscard]] Geometry merge_scans(std::span<const Geometry> scans, const AlignResult& aligned,
                                   const RunContext& context = {});

}  // namespace shapelight
