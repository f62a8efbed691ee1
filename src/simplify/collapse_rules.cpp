#include "simplify/collapse_rules.hpp"

#include <algorithm>
#include <cmath>

namespace shapelight::simplify {
namespace {

// Share of its trace added to a matrix before it is solved about the edge's midpoint.
constexpr float kDamping = 1e-4f;

}  // namespace

CollapseRule::CollapseRule(CollapseMesh& mesh, std::span<const float> removal_weight) : mesh_(mesh) {
  if (removal_weight.empty()) return;
  weight_.resize(mesh.size());
  for (Index v = 0; v < mesh.size(); ++v) weight_[v] = removal_weight[mesh.original(v)];
}

float CollapseRule::weighted(float cost, float weight) const {
  // Costs lie between the square of single precision and the largest boundary weight, far from either end of float.
  constexpr float kLeast = 1e-20f, kMost = 1e8f, kLast = 1e30f;
  return std::isinf(weight) ? std::clamp(cost, kLeast, kMost) * kLast : std::min(cost * weight, kMost);
}

float InputRule::cost(Index u, Index v) const {
  const auto& from = mesh_.vertex(u);
  if (from.flags & (CollapseMesh::kLocked | CollapseMesh::kLine)) {
    if (from.is(CollapseMesh::kLocked) || !mesh_.is_next_on_line(u, v)) return kNever;
  }
  const Vec3f d = mesh_.point(v).position() - mesh_.point(u).position();
  const float rise = mesh_.point(u).error + from.quadric.rise(d);
  const float error =
      std::max(rise, 0.0f) + mesh_.point(v).error + kLengthPenalty * from.quadric.trace() * d.squaredNorm();
  return weight_.empty() ? error : weighted(error, weight_[u]);
}

bool InputRule::is_legal(Index u, Index v, bool slivers) const {
  return mesh_.keeps_topology(u, v) && mesh_.keeps_faces(u, v, mesh_.point(v).position(), slivers);
}

InputRule::Outcome InputRule::collapse(Index u, Index v) {
  const Vec3f d = mesh_.point(v).position() - mesh_.point(u).position();
  const Quadric& gone = mesh_.vertex(u).quadric;
  mesh_.point(v).error += std::max(mesh_.point(u).error + gone.rise(d), 0.0f);
  mesh_.vertex(v).quadric += gone.about(d);
  return {mesh_.collapse(u, v), v, true};
}

bool OptimalRule::is_allowed(Index u, Index v) const {
  const auto& a = mesh_.vertex(u);
  const auto& b = mesh_.vertex(v);
  constexpr auto kEither = CollapseMesh::kLocked | CollapseMesh::kLine;
  if (!(a.flags & kEither) || !(b.flags & kEither)) return true;
  if (a.is(CollapseMesh::kLocked) && b.is(CollapseMesh::kLocked)) return false;
  return mesh_.is_next_on_line(a.is(CollapseMesh::kLocked) ? v : u, a.is(CollapseMesh::kLocked) ? u : v);
}

float OptimalRule::cost(Index u, Index v) const {
  const std::uint32_t stamp_u = mesh_.vertex(u).stamp, stamp_v = mesh_.vertex(v).stamp;
  if (stamp_u < stamp_v || (stamp_u == stamp_v && u < v) || !is_allowed(u, v)) return kNever;
  const float trace = mesh_.vertex(u).quadric.trace() + mesh_.vertex(v).quadric.trace();
  const float length_sq = (mesh_.point(v).position() - mesh_.point(u).position()).squaredNorm();
  const float error = merge(u, v).error + kLengthPenalty * trace * length_sq;
  return weight_.empty() ? error : weighted(error, std::max(weight_[u], weight_[v]));
}

OptimalRule::Merger OptimalRule::merge(Index u, Index v) const {
  const auto& a = mesh_.vertex(u);
  const auto& b = mesh_.vertex(v);
  const Vec3f pu = mesh_.point(u).position(), pv = mesh_.point(v).position();
  const float constant = mesh_.point(u).error + mesh_.point(v).error;
  const Vec3f d = pv - pu;
  const Merger into_v{u, v, pv, constant + std::max(a.quadric.rise(d), 0.0f)};
  const Merger into_u{v, u, pu, constant + std::max(b.quadric.rise(-d), 0.0f)};
  const auto rank = [](const CollapseMesh::Vertex& w) {
    return w.is(CollapseMesh::kLocked) ? 2 : w.is(CollapseMesh::kLine) ? 1 : 0;
  };
  if (rank(a) != rank(b)) return rank(a) < rank(b) ? into_v : into_u;

  // Where the minimum hardly beats an end, or is not unique, the end is better: an input position is exact.
  const Merger& end = into_u.error < into_v.error ? into_u : into_v;
  const float tie = kLengthPenalty * (a.quadric.trace() + b.quadric.trace()) * d.squaredNorm();
  if (end.error <= tie) return end;
  const Vec3f half = 0.5f * d;
  Quadric sum = a.quadric.about(half);
  sum += b.quadric.about(-half);
  const Vec3f y = sum.minimum(kDamping * sum.trace());
  const float at_middle = constant + a.quadric.rise(half) + b.quadric.rise(-half);
  const float error = std::max(at_middle + sum.rise(y), 0.0f);
  if (!(error + tie < end.error)) return end;
  const Vec3f p = pu + half + y;
  return y.dot(d) > 0.0f ? Merger{u, v, p, error} : Merger{v, u, p, error};
}

bool OptimalRule::is_legal(Index u, Index v, bool slivers) const {
  const Merger m = merge(u, v);
  return mesh_.keeps_topology(m.removed, m.kept) && mesh_.keeps_faces(m.removed, m.kept, m.position, slivers) &&
         (m.position == mesh_.point(m.kept).position() ||
          mesh_.keeps_faces(m.kept, m.removed, m.position, slivers));
}

InputRule::Outcome OptimalRule::collapse(Index u, Index v) {
  const Merger m = merge(u, v);
  auto& kept = mesh_.vertex(m.kept);
  auto& at = mesh_.point(m.kept);
  kept.quadric = kept.quadric.about(m.position - at.position());
  kept.quadric += mesh_.vertex(m.removed).quadric.about(m.position - mesh_.point(m.removed).position());
  if (m.position != at.position()) kept.set(CollapseMesh::kMoved);
  at = {m.position.x(), m.position.y(), m.position.z(), m.error};
  kept.stamp = ++clock_;
  if (!weight_.empty()) weight_[m.kept] = std::max(weight_[m.kept], weight_[m.removed]);
  return {mesh_.collapse(m.removed, m.kept), m.kept, false};
}

}  // namespace shapelight::simplify
