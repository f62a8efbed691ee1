#include "shapelight/registration/joint_refinement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "registration/pose_solver.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using registration::PairCost;
using registration::PairTerm;

constexpr double kSameSide = 0.5;        // cosine between the normals of points that correspond
constexpr double kSmallestSigma = 0.01;  // [target spacings] no pair of scans fits better than this
constexpr double kOutlier = 3.0;         // [sigma]
constexpr int kStepsPerMatching = 2;
constexpr double kCostTolerance = 1e-12;

// A sample of the source and the target's tangent plane at the point nearest to it.
struct Match {
  Vec3 p, q, n;  // source frame; target frame
  double weight = 0.0;
  [[nodiscard]] double distance(const RigidTransform& T_target_source) const { return n.dot(T_target_source * p - q); }
};

struct Matches {
  std::size_t target = 0, source = 0;
  std::vector<Match> pairs;
};

std::vector<Match> match(const ScanView& target, const ScanView& source, const RigidTransform& T_target_source,
                         const JointRefinementOptions& options) {
  const RegistrationCloud& full = *target.full;
  const RegistrationCloud& samples = *source.samples;
  const double max_across = options.max_distance * full.spacing, max_along = options.max_slide * full.spacing;
  const bool is_signed = full.viewpoint && source.full->viewpoint;
  std::vector<Match> matches;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 p = T_target_source * samples.position[i];
    const Neighbor nearest = full.tree.nearest(p);
    if (nearest.distance_sq > max_across * max_across + max_along * max_along) continue;
    const Vec3& n = full.normal[nearest.index];
    const Vec3 off = p - full.position[nearest.index];
    const double across = n.dot(off);
    if (std::abs(across) > max_across || (off - across * n).norm() > max_along) continue;
    const double cosine = n.dot(T_target_source.linear() * samples.normal[i]);
    if ((is_signed ? cosine : std::abs(cosine)) < kSameSide) continue;
    matches.push_back({samples.position[i], full.position[nearest.index], n, 1.0});
  }
  return matches;
}

// Standard deviation of the distances, from their median, so that outliers have no say.
double robust_sigma(const std::vector<Match>& matches, const RigidTransform& T_target_source, double spacing) {
  std::vector<double> distance;
  for (const Match& m : matches) distance.push_back(std::abs(m.distance(T_target_source)));
  const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
  std::nth_element(distance.begin(), middle, distance.end());
  return std::max(1.4826 * *middle, kSmallestSigma * spacing);
}

void set_weights(std::vector<Match>& matches, const RigidTransform& T_target_source, double spacing) {
  if (matches.empty()) return;
  const double sigma = robust_sigma(matches, T_target_source, spacing);
  for (Match& m : matches) {
    const double relative = m.distance(T_target_source) / (kOutlier * sigma);
    const double robust = 1.0 / (1.0 + relative * relative);
    m.weight = robust * robust / (sigma * sigma);
  }
}

struct TermAndCost {
  PairTerm term;
  double cost = 0.0;
};

// Sum of weight (n . (T p - q))^2 and its derivatives by a motion of T from the left.
TermAndCost quadratic(const Matches& matches, const RigidTransform& T_target_source) {
  TermAndCost total;
  total.term.target = matches.target;
  total.term.source = matches.source;
  for (const Match& m : matches.pairs) {
    const Vec3 p = T_target_source * m.p;
    const double distance = m.n.dot(p - m.q);
    Vector6 slope;
    slope << p.cross(m.n), m.n;
    total.term.hessian += 2.0 * m.weight * slope * slope.transpose();
    total.term.gradient += 2.0 * m.weight * distance * slope;
    total.cost += m.weight * distance * distance;
  }
  return total;
}

class JointFit {
 public:
  JointFit(std::span<const ScanView> scans, std::span<const std::pair<std::size_t, std::size_t>> pairs,
           std::span<const RigidTransform> T_world_scan, const JointRefinementOptions& options,
           const RunContext& context)
      : scans_(scans), options_(options), context_(context), poses_(T_world_scan.begin(), T_world_scan.end()) {
    registration::ScanGroups groups(scans.size());
    for (const auto& [a, b] : pairs) {
      groups.unite(a, b);
      matches_.push_back({a, b, {}});
      matches_.push_back({b, a, {}});
    }
    is_fixed_ = groups.first_of_each();
  }

  JointRefinementResult run() {
    JointRefinementResult result;
    while (!matches_.empty() && !result.converged &&
           result.iterations < static_cast<std::size_t>(options_.max_iterations)) {
      find_matches();
      const std::vector<RigidTransform> before = poses_;
      registration::fit_poses(
          poses_, is_fixed_, [&](std::span<const RigidTransform> poses) { return cost(poses); }, kStepsPerMatching,
          kCostTolerance, context_);
      ++result.iterations;
      result.converged = largest_move(before) <= options_.tolerance;
      context_.report(static_cast<double>(result.iterations) / options_.max_iterations);
    }
    result.converged = result.converged || matches_.empty();
    result.T_world_scan = std::move(poses_);
    return result;
  }

 private:
  [[nodiscard]] RigidTransform relative(const Matches& m, std::span<const RigidTransform> poses) const {
    return poses[m.target].inverse() * poses[m.source];
  }

  void find_matches() {
    parallel::run_chunks(context_, matches_.size(), [&](std::size_t i) {
      Matches& m = matches_[i];
      const RigidTransform T_target_source = relative(m, poses_);
      m.pairs = match(scans_[m.target], scans_[m.source], T_target_source, options_);
      set_weights(m.pairs, T_target_source, scans_[m.target].full->spacing);
    });
  }

  [[nodiscard]] PairCost cost(std::span<const RigidTransform> poses) const {
    std::vector<TermAndCost> parts(matches_.size());
    parallel::run_chunks(context_, matches_.size(),
                         [&](std::size_t i) { parts[i] = quadratic(matches_[i], relative(matches_[i], poses)); });
    PairCost total;
    for (const TermAndCost& part : parts) {
      total.terms.push_back(part.term);
      total.value += part.cost;
    }
    return total;
  }

  // [target spacings] of the corners of the scans' boxes, by their diagonals.
  [[nodiscard]] double largest_move(std::span<const RigidTransform> before) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const Vector6 move = registration::coordinates_of(before[i].inverse() * poses_[i]);
      const double size = move.tail<3>().norm() + 0.5 * scans_[i].full->diagonal * move.head<3>().norm();
      if (size > 0.0) largest = std::max(largest, size / scans_[i].full->spacing);
    }
    return largest;
  }

  std::span<const ScanView> scans_;
  const JointRefinementOptions& options_;
  const RunContext& context_;
  std::vector<RigidTransform> poses_;
  std::vector<bool> is_fixed_;
  std::vector<Matches> matches_;
};

void check_normals(const ScanView& scan, std::size_t index) {
  if (scan.full->normal.size() != scan.full->size() || scan.samples->normal.size() != scan.samples->size()) {
    throw InvalidInput(fmt::format("joint refinement: scan {} has no normals", index));
  }
}

}  // namespace

PairFit measure_fit(const ScanView& target, const ScanView& source, const RigidTransform& T_target_source,
                    const JointRefinementOptions& options) {
  validate_options(options);
  check_normals(target, 0);
  check_normals(source, 1);
  PairFit fit;
  double sum = 0.0;
  const auto add = [&](const ScanView& to, const ScanView& from, const RigidTransform& T) {
    const std::vector<Match> matches = match(to, from, T, options);
    for (const Match& m : matches) sum += m.distance(T) * m.distance(T);
    fit.matches += matches.size();
    if (from.samples->size() == 0) return;
    fit.overlap =
        std::max(fit.overlap, static_cast<double>(matches.size()) / static_cast<double>(from.samples->size()));
  };
  add(target, source, T_target_source);
  add(source, target, T_target_source.inverse());
  if (fit.matches > 0) fit.rms = std::sqrt(sum / static_cast<double>(fit.matches));
  return fit;
}

JointRefinementResult refine_jointly(std::span<const ScanView> scans,
                                     std::span<const std::pair<std::size_t, std::size_t>> pairs,
                                     std::span<const RigidTransform> T_world_scan,
                                     const JointRefinementOptions& options, const RunContext& context) {
  validate_options(options);
  if (scans.size() != T_world_scan.size()) {
    throw InvalidInput(
        fmt::format("joint refinement: {} poses for {} scans, expected one each", T_world_scan.size(), scans.size()));
  }
  for (const auto& [a, b] : pairs) {
    if (a >= scans.size() || b >= scans.size() || a == b) {
      throw InvalidInput(
          fmt::format("joint refinement: pair ({}, {}), expected two different scans of {}", a, b, scans.size()));
    }
    check_normals(scans[a], a);
    check_normals(scans[b], b);
  }
  return JointFit(scans, pairs, T_world_scan, options, context).run();
}

}  // namespace shapelight
