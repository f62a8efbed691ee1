#include "registration/loop_checks.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "registration/pose_solver.hpp"

namespace shapelight::registration {
namespace {

constexpr double kClosesByChance = 0.01;  // a loop with a wrong edge
constexpr double kFailsByChance = 0.02;   // one of right edges: covariances are estimates too
constexpr double kSurest = 0.99;          // confidences are never taken for certainty
constexpr int kRounds = 50;

// One edge walked from `from` to its other end: p_from = T p_to.
struct Step {
  RigidTransform T = RigidTransform::Identity();
  Matrix6 covariance;  // about the origin of `from`
  std::size_t to = 0;
};

Step walk(const PoseGraphEdge& edge, std::size_t from) {
  if (edge.target == from) return {edge.T_target_source, edge.covariance, edge.source};
  const RigidTransform inverse = edge.T_target_source.inverse();
  const Matrix6 A = adjoint(inverse);
  return {inverse, A * edge.covariance * A.transpose(), edge.target};
}

bool closes(std::span<const PoseGraphEdge> edges, std::span<const std::size_t> path, std::size_t start,
            double max_chi_sq) {
  RigidTransform T = RigidTransform::Identity();
  Matrix6 covariance = Matrix6::Zero();
  std::size_t at = start;
  for (const std::size_t e : path) {
    const Step step = walk(edges[e], at);
    const Matrix6 A = adjoint(T);
    covariance += A * step.covariance * A.transpose();
    T = T * step.T;
    at = step.to;
  }
  const Vector6 gap = coordinates_of(T);
  return gap.dot(covariance.ldlt().solve(gap)) <= max_chi_sq;
}

// Log-odds that a loop adds to one of its edges when the others are all right with probability `others`.
double message(bool agrees, double others) {
  return agrees
             ? std::log((others * (1.0 - kFailsByChance) + (1.0 - others) * kClosesByChance) / kClosesByChance)
             : std::log((others * kFailsByChance + (1.0 - others) * (1.0 - kClosesByChance)) / (1.0 - kClosesByChance));
}

double probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

double log_odds(double confidence) {
  const double p = std::clamp(confidence, 1.0 - kSurest, kSurest);
  return std::log(p / (1.0 - p));
}

}  // namespace

std::vector<Loop> find_loops(std::size_t num_scans, std::span<const PoseGraphEdge> edges,
                             const std::vector<bool>& is_candidate, double max_chi_sq) {
  std::vector<std::vector<std::size_t>> at(num_scans);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!is_candidate[e]) continue;
    at[edges[e].target].push_back(e);
    at[edges[e].source].push_back(e);
  }
  std::vector<Loop> loops;
  const auto add = [&](std::vector<std::size_t> path, std::size_t start) {
    const bool agrees = closes(edges, path, start, max_chi_sq);
    loops.push_back({std::move(path), agrees});
  };
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!is_candidate[e]) continue;
    const std::size_t start = edges[e].target, middle = edges[e].source;
    for (const std::size_t f : at[middle]) {
      if (f <= e) continue;
      const std::size_t last = edges[f].target == middle ? edges[f].source : edges[f].target;
      if (last == start) {
        add({e, f}, start);
        continue;
      }
      for (const std::size_t g : at[last]) {
        // Each triangle is met once: from its first edge, in the direction that leads over f.
        const bool is_closing = edges[g].target == start || edges[g].source == start;
        if (g > e && is_closing) add({e, f, g}, start);
      }
    }
  }
  return loops;
}

std::vector<double> confidence_after_loops(std::span<const PoseGraphEdge> edges, std::span<const Loop> loops) {
  std::vector<double> prior(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) prior[e] = log_odds(edges[e].confidence);
  std::vector<std::vector<double>> messages(loops.size());  // to each edge of each loop
  for (std::size_t l = 0; l < loops.size(); ++l) messages[l].assign(loops[l].edges.size(), 0.0);
  std::vector<double> belief = prior;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> next = prior;
    for (std::size_t l = 0; l < loops.size(); ++l) {
      const std::vector<std::size_t>& members = loops[l].edges;
      const std::vector<double> before = messages[l];
      for (std::size_t i = 0; i < members.size(); ++i) {
        double others = 1.0;
        for (std::size_t j = 0; j < members.size(); ++j) {
          if (j != i) others *= probability(belief[members[j]] - before[j]);
        }
        // Halfway only: loops of loops would swing to and fro.
        messages[l][i] = 0.5 * (before[i] + message(loops[l].agrees, others));
        next[members[i]] += messages[l][i];
      }
    }
    belief = std::move(next);
  }
  for (double& b : belief) b = probability(b);
  return belief;
}

}  // namespace shapelight::registration
