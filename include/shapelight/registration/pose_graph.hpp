#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/pose_assessment.hpp"

namespace shapelight {

/// What one pairwise registration says about two scans.
struct PoseGraphEdge {
  std::size_t target = 0;
  std::size_t source = 0;
  RigidTransform T_target_source = RigidTransform::Identity();
  Matrix6 covariance = Matrix6::Identity();  ///< of (rotation [rad], translation [length]) about the target's origin
  double confidence = 1.0;                   ///< [1] probability that it is right, before any loop was looked at
};

/// Parameters of optimize_pose_graph().
struct PoseGraphOptions {
  double min_confidence = 0.5;  ///< [1] edges that are less sure, once the loops were looked at, are dropped
  double max_chi_sq = 22.46;    ///< [1] edges and loops that disagree by more are wrong; 999 right ones in 1000 pass
  int max_iterations = 100;     ///< [iterations] of the last fit

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"min-confidence", "1", "Pairs that are less sure are not used.", 0, 1}, o.min_confidence);
    visit(OptionInfo{"max-chi-sq", "1", "Pairs and loops that disagree by more are wrong.", 1, 1e12}, o.max_chi_sq);
    visit(OptionInfo{"max-iterations", "iterations", "Iterations of the last fit at most.", 1, 100000},
          o.max_iterations);
  }
};

/// What became of an edge.
enum class EdgeUse : std::uint8_t {
  Used,
  LowConfidence,  ///< nobody was sure of it in the first place
  LoopsDisagree,  ///< the loops through it do not close
  PosesDisagree,  ///< the poses that the other edges agree on contradict it
};

[[nodiscard]] constexpr auto enum_names(EdgeUse) {
  return std::array<std::pair<EdgeUse, std::string_view>, 4>{{{EdgeUse::Used, "used"},
                                                              {EdgeUse::LowConfidence, "low confidence"},
                                                              {EdgeUse::LoopsDisagree, "loops disagree"},
                                                              {EdgeUse::PosesDisagree, "poses disagree"}}};
}

/// How poses differ from what was measured.
struct EdgeDisagreement {
  double rotation = 0.0;     ///< [rad]
  double translation = 0.0;  ///< [input length unit]
  double chi_sq = 0.0;       ///< [1] in standard deviations, squared; 6 are expected
};
/// Throws InvalidInput when the edge names a scan without a pose.
[[nodiscard]] EdgeDisagreement measure_disagreement(const PoseGraphEdge& edge,
                                                    std::span<const RigidTransform> T_world_scan);

struct PoseGraphEdgeResult {
  EdgeUse use = EdgeUse::Used;
  double confidence = 0.0;  ///< [1] after the loops: those that close speak for an edge, those that do not, against it
  std::size_t loops_agree = 0;     ///< loops of two or three edges through it that close
  std::size_t loops_disagree = 0;  ///< ... and that do not
  EdgeDisagreement disagreement;   ///< of the final poses; NaN between scans of different groups
};

struct PoseGraphResult {
  std::vector<RigidTransform> T_world_scan;  ///< per scan; the world of a group is the frame of its first scan
  std::vector<std::size_t> group;            ///< per scan; group 0 is the largest, equal ones by their first scan
  std::size_t num_groups = 0;
  std::vector<PoseGraphEdgeResult> edges;
  double chi_sq_before = 0.0;  ///< [1] sum over the used edges, with the poses of the spanning tree
  double chi_sq_after = 0.0;
  bool converged = true;
};

/// Poses of scans from registrations of pairs, some of which may be wrong. In order: every loop of two or three edges
/// is checked, and belief propagation over the loops turns the edges' confidences into what they are once all loops
/// are known; the most confident spanning tree gives poses to start from; Levenberg-Marquardt minimises the sum of
/// rho(e^T covariance^-1 e), e = log(T_w_target^-1 T_w_source T_target_source^-1), with Geman and McClure's rho made
/// narrower step by step (graduated non-convexity, Yang et al. 2020); the edges that then disagree are dropped, and
/// the others are fitted once more without rho.
/// Pre: edges join two different scans below num_scans; poses finite; covariances positive definite; confidences in
/// [0, 1] (InvalidInput names the edge). Throws InvalidInput, Cancelled.
/// Cost: a sparse factorisation per iteration, and one small one per loop.
[[nodiscard]] PoseGraphResult optimize_pose_graph(std::size_t num_scans, std::span<const PoseGraphEdge> edges,
                                                  const PoseGraphOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
