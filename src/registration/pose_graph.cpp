#include "shapelight/registration/pose_graph.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "registration/loop_checks.hpp"
#include "registration/pose_solver.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using registration::PairCost;
using registration::ScanGroups;

constexpr double kTolerance = 1e-20;      // of chi^2: down to rounding
constexpr double kWidestKernel = 4096.0;  // [max_chi_sq] where graduated non-convexity starts, and ...
constexpr double kNarrowing = 4.0;        // ... by how much each step narrows it
constexpr int kIterationsPerKernel = 20;
constexpr int kMaxSelections = 20;

void check(std::size_t num_scans, std::span<const PoseGraphEdge> edges) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const PoseGraphEdge& edge = edges[e];
    const auto refuse = [&](const char* what) {
      throw InvalidInput(fmt::format("pose graph: edge {} ({} to {}): {}", e, edge.source, edge.target, what));
    };
    if (edge.target >= num_scans || edge.source >= num_scans || edge.target == edge.source) {
      refuse("expected two different scans of those given");
    }
    if (!edge.T_target_source.matrix().allFinite()) refuse("the pose is not finite");
    if (!(edge.confidence >= 0.0 && edge.confidence <= 1.0)) refuse("expected a confidence in [0, 1]");
    const Eigen::LLT<Matrix6> factors(edge.covariance);
    if (!edge.covariance.allFinite() || factors.info() != Eigen::Success) {
      refuse("expected a positive definite covariance");
    }
  }
}

// What the poses say, in the target's frame, after undoing what was measured.
RigidTransform error_of(const PoseGraphEdge& edge, std::span<const RigidTransform> poses) {
  return poses[edge.target].inverse() * poses[edge.source] * edge.T_target_source.inverse();
}

class Graph {
 public:
  Graph(std::size_t num_scans, std::span<const PoseGraphEdge> edges, const PoseGraphOptions& options,
        const RunContext& context)
      : num_scans_(num_scans), edges_(edges), options_(options), context_(context), information_(edges.size()) {
    result_.T_world_scan.assign(num_scans, RigidTransform::Identity());
    result_.edges.resize(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      information_[e] = edges[e].covariance.llt().solve(Matrix6::Identity());
      result_.edges[e].confidence = edges[e].confidence;
      if (edges[e].confidence < options.min_confidence) result_.edges[e].use = EdgeUse::LowConfidence;
    }
  }

  PoseGraphResult run() {
    check_loops();
    place_by_spanning_tree();
    const std::vector<RigidTransform> start = result_.T_world_scan;
    anneal();
    select();
    set_groups();
    measure(start);
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::vector<bool> used() const {
    std::vector<bool> is_used(edges_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) is_used[e] = result_.edges[e].use == EdgeUse::Used;
    return is_used;
  }

  [[nodiscard]] ScanGroups groups_of(const std::vector<bool>& is_used) const {
    ScanGroups groups(num_scans_);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (is_used[e]) groups.unite(edges_[e].target, edges_[e].source);
    }
    return groups;
  }

  void check_loops() {
    const std::vector<registration::Loop> loops =
        registration::find_loops(num_scans_, edges_, used(), options_.max_chi_sq);
    for (const registration::Loop& loop : loops) {
      for (const std::size_t e : loop.edges)
        ++(loop.agrees ? result_.edges[e].loops_agree : result_.edges[e].loops_disagree);
    }
    const std::vector<double> confidence = registration::confidence_after_loops(edges_, loops);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      PoseGraphEdgeResult& edge = result_.edges[e];
      if (edge.loops_agree + edge.loops_disagree == 0) continue;
      edge.confidence = confidence[e];
      if (confidence[e] < options_.min_confidence) edge.use = EdgeUse::LoopsDisagree;
    }
  }

  // Kruskal: the most confident edges first.
  void place_by_spanning_tree() {
    std::vector<std::size_t> order(edges_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return result_.edges[a].confidence > result_.edges[b].confidence;
    });
    ScanGroups groups(num_scans_);
    std::vector<std::vector<std::size_t>> members(num_scans_);  // of the set whose first scan this is
    for (std::size_t i = 0; i < num_scans_; ++i) members[i] = {i};
    for (const std::size_t e : order) {
      if (result_.edges[e].use != EdgeUse::Used) continue;
      const auto [target, source] = std::pair(groups.find(edges_[e].target), groups.find(edges_[e].source));
      if (!groups.unite(target, source)) continue;
      const RigidTransform T_target_source = result_.T_world_scan[edges_[e].target] * edges_[e].T_target_source *
                                             result_.T_world_scan[edges_[e].source].inverse();
      join(members, target, source, T_target_source);
    }
  }

  // Moves the later set into the frame of the earlier one.
  void join(std::vector<std::vector<std::size_t>>& members, std::size_t target, std::size_t source,
            const RigidTransform& T_target_source) {
    const auto [first, other] = std::minmax(target, source);
    const RigidTransform T_first_other = first == target ? T_target_source : T_target_source.inverse();
    for (const std::size_t scan : members[other]) {
      result_.T_world_scan[scan] = T_first_other * result_.T_world_scan[scan];
      members[first].push_back(scan);
    }
    members[other].clear();
  }

  // Sum of width chi^2 / (width + chi^2); an infinite width is plain least squares.
  [[nodiscard]] PairCost cost(std::span<const RigidTransform> poses, const std::vector<bool>& is_used,
                              double width) const {
    PairCost total;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (!is_used[e]) continue;
      const RigidTransform off = error_of(edges_[e], poses);
      const Vector6 error = registration::coordinates_of(off);
      const double here = error.dot(information_[e] * error);
      const double relative = 1.0 / (1.0 + here / width);
      const Matrix6 J = registration::coordinate_jacobian(off);
      const Matrix6 JtI = 2.0 * relative * relative * J.transpose() * information_[e];
      total.terms.push_back({edges_[e].target, edges_[e].source, JtI * J, JtI * error});
      total.value += here * relative;
    }
    return total;
  }

  bool fit(double width, int max_iterations) {
    const std::vector<bool> is_used = used();
    return registration::fit_poses(
               result_.T_world_scan, groups_of(is_used).first_of_each(),
               [&](std::span<const RigidTransform> poses) { return cost(poses, is_used, width); }, max_iterations,
               kTolerance, context_)
        .converged;
  }

  void anneal() {
    for (double width = kWidestKernel; width >= 1.0; width /= kNarrowing) {
      fit(width * options_.max_chi_sq, kIterationsPerKernel);
    }
  }

  // Edges that disagree with the poses are dropped and the others fitted, until the choice stands. An edge whose loops
  // spoke against it, perhaps for their other edges' faults, is used where all poses agree with it.
  void select() {
    for (int round = 0; round < kMaxSelections; ++round) {
      bool is_same = round > 0;
      ScanGroups groups = groups_of(used());
      for (std::size_t e = 0; e < edges_.size(); ++e) {
        EdgeUse& use = result_.edges[e].use;
        if (use == EdgeUse::LowConfidence || groups.find(edges_[e].target) != groups.find(edges_[e].source)) continue;
        const bool agrees = measure_disagreement(edges_[e], result_.T_world_scan).chi_sq <= options_.max_chi_sq;
        if (agrees == (use == EdgeUse::Used)) continue;
        use = agrees ? EdgeUse::Used : EdgeUse::PosesDisagree;
        is_same = false;
      }
      if (is_same) return;
      result_.converged = fit(std::numeric_limits<double>::infinity(), options_.max_iterations);
    }
  }

  // Sets of scans that used edges connect, largest first, each in the frame of its first scan.
  void set_groups() {
    ScanGroups groups = groups_of(used());
    std::vector<std::size_t> size(num_scans_, 0), order;
    for (std::size_t i = 0; i < num_scans_; ++i) {
      if (size[groups.find(i)]++ == 0) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size[a] > size[b]; });
    result_.num_groups = order.size();
    result_.group.resize(num_scans_);
    std::vector<std::size_t> number(num_scans_);
    for (std::size_t g = 0; g < order.size(); ++g) number[order[g]] = g;
    const std::vector<RigidTransform> before = result_.T_world_scan;
    for (std::size_t i = 0; i < num_scans_; ++i) {
      const std::size_t first = groups.find(i);
      result_.group[i] = number[first];
      result_.T_world_scan[i] = i == first ? RigidTransform::Identity() : before[first].inverse() * before[i];
    }
  }

  void measure(std::span<const RigidTransform> start) {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      PoseGraphEdgeResult& edge = result_.edges[e];
      constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
      edge.disagreement = {kNaN, kNaN, kNaN};
      if (result_.group[edges_[e].target] != result_.group[edges_[e].source]) continue;
      edge.disagreement = measure_disagreement(edges_[e], result_.T_world_scan);
      if (edge.use != EdgeUse::Used) continue;
      result_.chi_sq_before += measure_disagreement(edges_[e], start).chi_sq;
      result_.chi_sq_after += edge.disagreement.chi_sq;
    }
  }

  std::size_t num_scans_;
  std::span<const PoseGraphEdge> edges_;
  PoseGraphOptions options_;
  const RunContext& context_;
  std::vector<Matrix6> information_;
  PoseGraphResult result_;
};

}  // namespace

EdgeDisagreement measure_disagreement(const PoseGraphEdge& edge, std::span<const RigidTransform> T_world_scan) {
  if (std::max(edge.target, edge.source) >= T_world_scan.size()) {
    throw InvalidInput(fmt::format("pose graph: edge ({} to {}), expected scans below {}", edge.source, edge.target,
                                   T_world_scan.size()));
  }
  const Vector6 error = registration::coordinates_of(error_of(edge, T_world_scan));
  return {error.head<3>().norm(), error.tail<3>().norm(), error.dot(edge.covariance.llt().solve(error))};
}

PoseGraphResult optimize_pose_graph(std::size_t num_scans, std::span<const PoseGraphEdge> edges,
                                    const PoseGraphOptions& options, const RunContext& context) {
  validate_options(options);
  check(num_scans, edges);
  return Graph(num_scans, edges, options, context).run();
}

}  // namespace shapelight
