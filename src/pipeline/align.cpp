#include "shapelight/pipeline/align.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/parallel.hpp"
#include "registration/pose_solver.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/registration/joint_refinement.hpp"

namespace shapelight {
namespace {

using ScanIds = std::pair<std::size_t, std::size_t>;  // target, source; target < source

constexpr double kPairPrecision = 0.5;  // [spacings] no pair is known better: samples of a surface, not the surface
constexpr std::size_t kBatch = 32;      // [pairs] registered between two reports of progress
constexpr int kMaxClosingRounds = 3;

// A registered pair; the edge is between the origins of the prepared scans.
struct Registered {
  PoseGraphEdge edge;
  double overlap = 0.0;
  bool closes_loop = false;
};

RigidTransform shift(const Vec3& by) { return RigidTransform(Eigen::Translation3d(by)); }

// The assessment's covariance supposes independent errors and exact surfaces: it shrinks without bound with the number
// of points. What the spacing of the points allows is added to it.
Matrix6 realistic(const Matrix6& covariance, const RegistrationCloud& target, const RegistrationCloud& source) {
  const double slide = kPairPrecision * std::max(target.spacing, source.spacing);
  const double turn = slide / (0.5 * std::min(target.diagonal, source.diagonal));
  Vector6 variance;
  variance << Vec3::Constant(turn * turn), Vec3::Constant(slide * slide);
  Matrix6 sum = 0.5 * (covariance + covariance.transpose());
  sum.diagonal() += variance;
  if (sum.allFinite() && sum.llt().info() == Eigen::Success) return sum;
  variance << Vec3::Ones(), Vec3::Constant(target.diagonal * target.diagonal);  // nothing is known
  return variance.asDiagonal();
}

class Alignment {
 public:
  Alignment(std::span<const GeometryView> scans, const AlignOptions& options, const RunContext& context)
      : options_(options), context_(context) {
    prepare(scans, context.phase(0.0, 0.2, "prepare scans"));
  }

  AlignResult run() {
    const bool is_sequence = options_.sequence || scans_.size() > options_.max_all_pairs;
    register_pairs(is_sequence ? neighbours() : all_pairs(), false, context_.phase(0.2, 0.7, "register pairs"));
    solve();
    if (is_sequence && !options_.sequence) {
      register_pairs(lost_and_placed(), false, context_.phase(0.7, 0.75, "find lost scans"));
      solve();
    }
    close_loops(context_.phase(0.75, 0.9, "close loops"));
    poses_ = graph_.T_world_scan;
    const std::vector<ScanIds> overlaps = overlapping_pairs();
    if (options_.refine) refine(overlaps, context_.phase(0.9, 0.98, "refine"));
    AlignResult aligned = result(overlaps);
    context_.report(1.0, "done");
    return aligned;
  }

 private:
  void prepare(std::span<const GeometryView> scans, const RunContext& context);
  [[nodiscard]] std::vector<ScanIds> all_pairs() const;
  [[nodiscard]] std::vector<ScanIds> neighbours() const;
  [[nodiscard]] std::vector<ScanIds> lost_and_placed() const;
  void register_pairs(const std::vector<ScanIds>& pairs, bool closes_loop, const RunContext& context);
  void keep_better(const ScanIds& pair, const Registered& registered);
  [[nodiscard]] Registered register_pair(const ScanIds& pair, bool closes_loop, const RunContext& context) const;
  void solve();
  void close_loops(const RunContext& context);
  [[nodiscard]] bool is_used(const ScanIds& pair) const;
  [[nodiscard]] bool may_touch(const ScanIds& pair) const;
  [[nodiscard]] std::vector<ScanIds> overlapping_pairs() const;
  void refine(const std::vector<ScanIds>& overlaps, const RunContext& context);
  [[nodiscard]] AlignResult result(const std::vector<ScanIds>& overlaps);
  void add_scans(AlignResult& result, const std::vector<ScanIds>& overlaps);
  void add_pairs(AlignResult& result) const;

  // The pose in input frames of one between origins.
  [[nodiscard]] RigidTransform between_inputs(std::size_t target, std::size_t source, const RigidTransform& T) const {
    return shift(scans_[target].origin) * T * shift(-scans_[source].origin);
  }
  [[nodiscard]] ScanView view(std::size_t scan) const { return {&scans_[scan].full, &scans_[scan].samples}; }
  [[nodiscard]] RigidTransform relative(const ScanIds& pair, const std::vector<RigidTransform>& poses) const {
    return poses[pair.first].inverse() * poses[pair.second];
  }

  AlignOptions options_;
  RunContext context_;
  std::vector<PreparedScan> scans_;
  std::map<ScanIds, Registered> registered_;
  std::vector<ScanIds> edges_;  // the keys, in order: edge e of the graph is pair edges_[e]
  PoseGraphResult graph_;
  std::vector<RigidTransform> poses_;  // between origins, as the graph's
  std::vector<std::string> warnings_;
};

void Alignment::prepare(std::span<const GeometryView> scans, const RunContext& context) {
  scans_.reserve(scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const double share = 1.0 / static_cast<double>(scans.size());
    scans_.push_back(prepare_scan(scans[i], options_.registration, fmt::format("scan {}", i),
                                  context.phase(share * double(i), share * double(i + 1), "prepare scans")));
  }
}

std::vector<ScanIds> Alignment::all_pairs() const {
  std::vector<ScanIds> pairs;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    for (std::size_t j = i + 1; j < scans_.size(); ++j) pairs.emplace_back(i, j);
  }
  return pairs;
}

std::vector<ScanIds> Alignment::neighbours() const {
  std::vector<ScanIds> pairs;
  for (std::size_t i = 0; i + 1 < scans_.size(); ++i) pairs.emplace_back(i, i + 1);
  return pairs;
}

// Scans that the first pairs left alone, each with all that were placed.
std::vector<ScanIds> Alignment::lost_and_placed() const {
  std::vector<ScanIds> pairs;
  for (const ScanIds& pair : all_pairs()) {
    const bool is_one_placed = (graph_.group[pair.first] == 0) != (graph_.group[pair.second] == 0);
    if (is_one_placed && !registered_.contains(pair)) pairs.push_back(pair);
  }
  return pairs;
}

// What was registered before stays unless the new pose is sure.
void Alignment::keep_better(const ScanIds& pair, const Registered& registered) {
  const auto [place, is_new] = registered_.try_emplace(pair, registered);
  if (!is_new && registered.edge.confidence >= options_.min_confidence) place->second = registered;
}

// Pairs in parallel, each on one thread: there are many of them, and each is a chain of small loops.
void Alignment::register_pairs(const std::vector<ScanIds>& pairs, bool closes_loop, const RunContext& context) {
  const RunContext quiet{context.max_threads, context.stop, {}};
  for (std::size_t begin = 0; begin < pairs.size(); begin += kBatch) {
    std::vector<Registered> batch(std::min(kBatch, pairs.size() - begin));
    parallel::run_chunks(quiet, batch.size(), [&](std::size_t i) {
      batch[i] = register_pair(pairs[begin + i], closes_loop, RunContext{1, context.stop, {}});
    });
    for (std::size_t i = 0; i < batch.size(); ++i) keep_better(pairs[begin + i], batch[i]);
    context.report(static_cast<double>(begin + batch.size()) / static_cast<double>(pairs.size()));
  }
}

Registered Alignment::register_pair(const ScanIds& pair, bool closes_loop, const RunContext& context) const {
  const auto [target, source] = pair;
  std::optional<RigidTransform> init;
  if (closes_loop) init = between_inputs(target, source, relative(pair, graph_.T_world_scan));
  const RegisterResult found = register_scans(scans_[source], scans_[target], init, options_.registration, context);
  Registered registered;
  registered.edge.target = target;
  registered.edge.source = source;
  registered.edge.T_target_source =
      shift(-scans_[target].origin) * found.T_target_source * shift(scans_[source].origin);
  registered.edge.confidence = found.assessment.confidence;
  registered.edge.covariance = realistic(found.assessment.covariance, scans_[target].full, scans_[source].full);
  registered.overlap = found.assessment.overlap;
  registered.closes_loop = closes_loop;
  return registered;
}

void Alignment::solve() {
  std::vector<PoseGraphEdge> edges;
  edges_.clear();
  for (const auto& [pair, registered] : registered_) {
    edges_.push_back(pair);
    edges.push_back(registered.edge);
  }
  PoseGraphOptions options;
  options.min_confidence = options_.min_confidence;
  graph_ = optimize_pose_graph(scans_.size(), edges, options, {context_.max_threads, context_.stop, {}});
}

bool Alignment::is_used(const ScanIds& pair) const {
  const auto found = std::lower_bound(edges_.begin(), edges_.end(), pair);
  if (found == edges_.end() || *found != pair) return false;
  return graph_.edges[static_cast<std::size_t>(found - edges_.begin())].use == EdgeUse::Used;
}

// The spheres about two placed scans meet; origins are the middles of the scans.
bool Alignment::may_touch(const ScanIds& pair) const {
  const auto& [a, b] = pair;
  if (graph_.group[a] != graph_.group[b]) return false;
  const double reach = 0.5 * (scans_[a].full.diagonal + scans_[b].full.diagonal);
  return (graph_.T_world_scan[a].translation() - graph_.T_world_scan[b].translation()).norm() <= reach;
}

// Pairs of one group whose surfaces lie on each other, and those that hold the group together.
std::vector<ScanIds> Alignment::overlapping_pairs() const {
  std::vector<ScanIds> near;
  for (const ScanIds& pair : all_pairs()) {
    if (may_touch(pair)) near.push_back(pair);
  }
  std::vector<char> overlaps(near.size());
  parallel::run_chunks({context_.max_threads, context_.stop, {}}, near.size(), [&](std::size_t i) {
    const auto& [a, b] = near[i];
    overlaps[i] = is_used(near[i]) ||
                  measure_fit(view(a), view(b), relative(near[i], graph_.T_world_scan)).overlap >= options_.min_overlap;
  });
  std::vector<ScanIds> pairs;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (overlaps[i] != 0) pairs.push_back(near[i]);
  }
  return pairs;
}

// Placed scans that overlap although their pair was not found, not sure or not tried: they are registered from where
// they lie, as long as that brings new pairs.
void Alignment::close_loops(const RunContext& context) {
  std::set<ScanIds> tried;
  for (int round = 0; round < kMaxClosingRounds; ++round) {
    std::vector<ScanIds> pairs;
    for (const ScanIds& pair : overlapping_pairs()) {
      if (!is_used(pair) && tried.insert(pair).second) pairs.push_back(pair);
    }
    if (pairs.empty()) break;
    register_pairs(pairs, true, context.phase(round / 3.0, (round + 1) / 3.0, "close loops"));
    solve();
  }
}

// A refinement that a pair in use contradicts by twice as many standard deviations as it may is not taken.
void Alignment::refine(const std::vector<ScanIds>& overlaps, const RunContext& context) {
  std::vector<ScanView> views;
  for (std::size_t i = 0; i < scans_.size(); ++i) views.push_back(view(i));
  const JointRefinementResult refined = refine_jointly(views, overlaps, poses_, {}, context);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (graph_.edges[e].use != EdgeUse::Used) continue;
    const EdgeDisagreement off = measure_disagreement(registered_.at(edges_[e]).edge, refined.T_world_scan);
    if (off.chi_sq <= 4.0 * PoseGraphOptions{}.max_chi_sq) continue;
    warnings_.push_back(fmt::format(
        "moving all scans at once would contradict the registration of scans {} and {}: their pairs' poses are kept",
        edges_[e].first, edges_[e].second));
    return;
  }
  poses_ = refined.T_world_scan;
}

AlignResult Alignment::result(const std::vector<ScanIds>& overlaps) {
  AlignResult result;
  result.num_groups = graph_.num_groups;
  result.num_placed = static_cast<std::size_t>(std::count(graph_.group.begin(), graph_.group.end(), 0));
  result.chi_sq_before = graph_.chi_sq_before;
  result.chi_sq_after = graph_.chi_sq_after;
  add_scans(result, overlaps);
  add_pairs(result);
  result.warnings = std::move(warnings_);
  return result;
}

void Alignment::add_scans(AlignResult& result, const std::vector<ScanIds>& overlaps) {
  std::vector<std::size_t> first(graph_.num_groups, scans_.size());
  result.scans.resize(scans_.size());
  for (std::size_t i = scans_.size(); i-- > 0;) first[graph_.group[i]] = i;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const std::size_t group = graph_.group[i];
    result.scans[i].group = group;
    if (i != first[group]) result.scans[i].T_world_scan = between_inputs(first[group], i, poses_[i]);
    if (group != 0) warnings_.push_back(fmt::format("scan {} is not placed: nothing sure connects it", i));
  }
  std::vector<PairFit> fits(overlaps.size());
  parallel::run_chunks({context_.max_threads, context_.stop, {}}, overlaps.size(), [&](std::size_t i) {
    fits[i] = measure_fit(view(overlaps[i].first), view(overlaps[i].second), relative(overlaps[i], poses_));
  });
  std::vector<double> sum(scans_.size(), 0.0), count(scans_.size(), 0.0);
  for (std::size_t i = 0; i < overlaps.size(); ++i) {
    const auto [a, b] = overlaps[i];
    for (const auto& [scan, partner] : {std::pair(a, b), std::pair(b, a)}) {
      result.scans[scan].partners.push_back(partner);
      sum[scan] += static_cast<double>(fits[i].matches) * fits[i].rms * fits[i].rms;
      count[scan] += static_cast<double>(fits[i].matches);
    }
  }
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    std::sort(result.scans[i].partners.begin(), result.scans[i].partners.end());
    if (count[i] > 0.0) result.scans[i].rms = std::sqrt(sum[i] / count[i]);
  }
}

void Alignment::add_pairs(AlignResult& result) const {
  result.pairs.resize(edges_.size());
  parallel::run_chunks({context_.max_threads, context_.stop, {}}, edges_.size(), [&](std::size_t e) {
    const auto [target, source] = edges_[e];
    const Registered& registered = registered_.at(edges_[e]);
    AlignedPair& pair = result.pairs[e];
    pair.target = target;
    pair.source = source;
    pair.T_target_source = between_inputs(target, source, registered.edge.T_target_source);
    pair.registration_confidence = registered.edge.confidence;
    pair.overlap = registered.overlap;
    pair.closes_loop = registered.closes_loop;
    pair.graph = graph_.edges[e];
    pair.rms_before = measure_fit(view(target), view(source), registered.edge.T_target_source).rms;
    if (graph_.group[target] != graph_.group[source]) return;
    pair.graph.disagreement = measure_disagreement(registered.edge, poses_);
    pair.rms_after = measure_fit(view(target), view(source), relative(edges_[e], poses_)).rms;
  });
}

}  // namespace

AlignResult align_scans(std::span<const GeometryView> scans, const AlignOptions& options, const RunContext& context) {
  validate_options(options);
  if (scans.size() < 2) throw InvalidInput(fmt::format("align: {} scans, expected two or more", scans.size()));
  return Alignment(scans, options, context).run();
}

}  // namespace shapelight
