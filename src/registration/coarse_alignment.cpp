#include "shapelight/registration/coarse_alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "registration/compatibility.hpp"
#include "registration/match_descriptors.hpp"
#include "registration/tune.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

struct Problem {
  const DescribedPoints& source;
  const DescribedPoints& target;
  std::vector<Match> matches;
  double tolerance;
};

RigidTransform fit(const Problem& problem, std::span<const std::size_t> chosen) {
  Vec3 ps = Vec3::Zero(), qs = Vec3::Zero();
  for (auto i : chosen) {
    ps += problem.source.position[problem.matches[i].source];
    qs += problem.target.position[problem.matches[i].target];
  }
  ps /= double(chosen.size());
  qs /= double(chosen.size());
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  const double s2 = problem.tolerance * problem.tolerance * 4;
  for (auto i : chosen) {
    const Match& m = problem.matches[i];
    H += (problem.source.position[m.source] - ps) * (problem.target.position[m.target] - qs).transpose();
    H += s2 * problem.source.normal[m.source] * (m.turned ? -1.0 : 1.0) * problem.target.normal[m.target].transpose();
  }
  Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d D = Eigen::Matrix3d::Identity();
  D(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
  RigidTransform T = RigidTransform::Identity();
  T.linear() = svd.matrixV() * D * svd.matrixU().transpose();
  T.translation() = qs - T.linear() * ps;
  return T;
}

std::vector<std::size_t> inliers(const Problem& problem, const RigidTransform& T) {
  std::vector<std::size_t> in;
  const double limit = problem.tolerance * problem.tolerance;
  for (std::size_t i = 0; i < problem.matches.size(); ++i) {
    const Match& m = problem.matches[i];
    if ((T * problem.source.position[m.source] - problem.target.position[m.target]).squaredNorm() > limit) continue;
    const double cosine = (T.linear() * problem.source.normal[m.source]).dot(problem.target.normal[m.target]);
    if ((m.turned ? -cosine : cosine) < tune::VCOS) continue;
    in.push_back(i);
  }
  return in;
}

struct Candidate {
  RigidTransform T;
  double score;
};

// share of keypoints (both ways) that lie on the other
double verify(const DescribedPoints& a, const DescribedPoints& b, const KdTree& tree, const RigidTransform& T, bool same_side) {
  int plus = 0, minus = 0;
  const double limit = std::pow(tune::VTOL * b.spacing, 2);
  for (Index k : a.keypoints) {
    const Neighbor near = tree.nearest(T * a.position[k]);
    if (near.distance_sq > limit) continue;
    const double cosine = (T.linear() * a.normal[k]).dot(b.normal[near.index]);
    plus += cosine > tune::VCOS;
    minus += cosine < -tune::VCOS;
  }
  (void)same_side;
  return (same_side ? plus : plus + minus) / double(a.keypoints.size());
}

bool alike(const RigidTransform& a, const RigidTransform& b, const Vec3& center, double radius, double tolerance) {
  const double angle = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
  return (a * center - b * center).norm() + angle * radius < tolerance;
}

}  // namespace

std::vector<PoseHypothesis> align_coarsely(const DescribedPoints& source, const DescribedPoints& target,
                                           const CoarseAlignmentOptions& options, const RunContext& context) {
  validate_options(options);
  const double tolerance = tune::TOL * std::max(source.spacing, target.spacing);
  Problem problem{source, target, match_descriptors(source, target, options.same_side, context), tolerance};
  const auto& matches = problem.matches;
  const CompatibilityGraph graph(source, target, matches, tolerance, context);
  const std::size_t n = graph.size();
  if (n < 3) return {};

  // leading eigenvector
  std::vector<double> score(n, 1.0), next(n);
  for (int pass = 0; pass < 6; ++pass) {
    double norm = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      graph.for_each(i, [&](std::size_t j) { sum += score[j]; });
      next[i] = sum;
      norm = std::max(norm, sum);
    }
    if (norm == 0) return {};
    for (std::size_t i = 0; i < n; ++i) score[i] = next[i] / norm;
  }
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  const double mode = tune::env("SEEDMODE", 0);
  if (mode == 1) for (std::size_t i = 0; i < n; ++i) { score[i] = 0; for (auto w : graph.row(i)) score[i] += std::popcount(w); }
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return score[a] > score[b] || (score[a] == score[b] && a < b); });
  std::vector<std::size_t> seeds;
  const double near2 = std::pow(tolerance * tune::env("SEEDNMS", 1.0), 2);
  for (std::size_t i : order) {
    if (seeds.size() >= tune::SEEDS) break;
    bool taken = false;
    for (std::size_t s : seeds)
      if ((source.position[matches[s].source] - source.position[matches[i].source]).squaredNorm() < near2 &&
          (target.position[matches[s].target] - target.position[matches[i].target]).squaredNorm() < near2) {
        taken = true;
        break;
      }
    if (!taken) seeds.push_back(i);
  }
  std::vector<Candidate> candidates;
  for (std::size_t s : seeds) {
    std::vector<std::pair<int, std::size_t>> friends;
    graph.for_each(s, [&](std::size_t j) { friends.emplace_back(-graph.common(s, j), j); });
    if (friends.size() < 2) continue;
    std::sort(friends.begin(), friends.end());
    if (friends.size() > tune::KSEED) friends.resize(std::size_t(tune::KSEED));
    std::vector<std::size_t> chosen{s};
    for (auto& f : friends) chosen.push_back(f.second);
    Candidate c{fit(problem, chosen), 0};
    for (int it = 0; it < 2; ++it) {
      chosen = inliers(problem, c.T);
      if (chosen.size() < 3) break;
      c.T = fit(problem, chosen);
    }
    c.score = double(inliers(problem, c.T).size());
    if (c.score >= 3) candidates.push_back(c);
  }
  const auto better = [](const Candidate& a, const Candidate& b) { return a.score > b.score; };
  std::stable_sort(candidates.begin(), candidates.end(), better);
  Vec3 center = Vec3::Zero();
  for (auto& p : source.position) center += p;
  center /= double(source.size());
  double radius = 0;
  for (auto& p : source.position) radius += (p - center).squaredNorm();
  radius = std::sqrt(radius / double(source.size()));
  std::vector<Candidate> distinct;
  for (auto& c : candidates) {
    if (distinct.size() >= tune::REFINE) break;
    bool old = false;
    for (auto& d : distinct) old = old || alike(c.T, d.T, center, radius, 3 * tolerance);
    if (!old) distinct.push_back(c);
  }
  if (tune::VERIFY > 0) {
    const KdTree ts(source.position), tt(target.position);
    for (auto& c : distinct) {
      const double a = verify(source, target, tt, c.T, options.same_side), b = verify(target, source, ts, c.T.inverse(), options.same_side);
      c.score = tune::VERIFY == 1 ? a + b : tune::VERIFY == 2 ? c.score * (a + b) : tune::VERIFY == 3 ? std::max(a, b) : std::sqrt(c.score) * (a + b);
    }
    std::stable_sort(distinct.begin(), distinct.end(), better);
  }
  std::vector<PoseHypothesis> result;
  for (auto& c : distinct) {
    if (result.size() >= std::size_t(options.max_hypotheses)) break;
    result.push_back({c.T, c.score});
  }
  return result;
}

}  // namespace shapelight
