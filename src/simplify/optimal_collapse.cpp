#include "simplify/collapse_loop.hpp"

namespace shapelight::simplification {
namespace {

// Share of its trace added to a matrix before it is solved about the edge's midpoint.
constexpr double kDamping = 1e-4;

// Placement::Optimal: u and v go where the sum of their quadrics is least. An edge belongs to the one of its ends that
// became what it is later; the sum of two quadrics only grows, so that the other end's older keys are lower bounds.
class OptimalRule : public CollapseRule<double> {
 public:
  using CollapseRule::CollapseRule;
  [[nodiscard]] float cost(Index u, Index v) const;
  // Does u still own the edge to its target? Then neither end has changed.
  [[nodiscard]] bool is_exact(Index u) const { return owns(u, mesh_.vertex(u).target); }
  // May u and v become one? If so, collapse() does it.
  [[nodiscard]] bool prepare(Index u, Index v, bool slivers);
  Outcome collapse();

 private:
  struct Merger {
    Index removed, kept;
    Vec3 position;
    double error;
    double tie;  ///< what errors must differ by to count
  };
  [[nodiscard]] Merger merge(Index u, Index v) const;
  [[nodiscard]] bool is_allowed(Index u, Index v) const;
  [[nodiscard]] bool owns(Index u, Index v) const {
    const std::uint32_t stamp_u = mesh_.vertex(u).stamp, stamp_v = mesh_.vertex(v).stamp;
    return stamp_u > stamp_v || (stamp_u == stamp_v && u > v);
  }
  Merger prepared_;
  std::uint32_t clock_ = 0;
};

bool OptimalRule::is_allowed(Index u, Index v) const {
  const auto& a = mesh_.vertex(u);
  const auto& b = mesh_.vertex(v);
  constexpr auto kEither = Mesh::kLocked | Mesh::kLine;
  if (!(a.flags & kEither) || !(b.flags & kEither)) return true;
  if (a.is(Mesh::kLocked) && b.is(Mesh::kLocked)) return false;
  return mesh_.is_next_on_line(a.is(Mesh::kLocked) ? v : u, a.is(Mesh::kLocked) ? u : v);
}

float OptimalRule::cost(Index u, Index v) const {
  if (!owns(u, v) || !is_allowed(u, v)) return kNever;
  const Merger m = merge(u, v);
  const float error = static_cast<float>(m.error + m.tie);
  return weight_.empty() ? error : weighted(error, std::max(weight_[u], weight_[v]));
}

OptimalRule::Merger OptimalRule::merge(Index u, Index v) const {
  const auto& a = mesh_.vertex(u);
  const auto& b = mesh_.vertex(v);
  const Vec3 pu = mesh_.point(u).position(), pv = mesh_.point(v).position();
  const Vec3 d = pv - pu, half = 0.5 * d;
  const double tie = kLengthPenalty * (a.quadric.trace() + b.quadric.trace()) * d.squaredNorm();
  // Of either quadric, half the slope in the middle of the edge: twice its rise over half the edge is that over all.
  const Vec3 linear_a = a.quadric.linear(), slope_a = linear_a + a.quadric.times(half);
  const Vec3 linear_b = b.quadric.linear(), slope_b = linear_b - b.quadric.times(half);
  const double constant = mesh_.point(u).error + mesh_.point(v).error;
  const Merger into_v{u, v, pv, constant + std::max(2.0 * d.dot(slope_a), 0.0), tie};
  const Merger into_u{v, u, pu, constant + std::max(-2.0 * d.dot(slope_b), 0.0), tie};
  const auto rank = [](const Mesh::Vertex& w) { return w.is(Mesh::kLocked) ? 2 : w.is(Mesh::kLine) ? 1 : 0; };
  if (rank(a) != rank(b)) return rank(a) < rank(b) ? into_v : into_u;

  // Where the minimum hardly beats an end, or is not unique, the end is better: an input position is exact.
  const Merger& end = into_u.error < into_v.error ? into_u : into_v;
  if (end.error <= tie) return end;
  Quadric<double> sum = a.quadric;
  sum += b.quadric;
  sum.set_linear(slope_a + slope_b);
  const Vec3 y = sum.minimum(kDamping * sum.trace());
  const double at_middle = constant + half.dot(slope_a + linear_a - slope_b - linear_b);
  const double error = std::max(at_middle + sum.rise(y), 0.0);
  if (!(error + tie < end.error)) return end;
  const Vec3 p = pu + half + y;
  // The one of greater weight lives on, else the nearer one.
  const bool keep_v = !weight_.empty() && weight_[u] != weight_[v] ? weight_[v] > weight_[u] : y.dot(d) > 0.0;
  return keep_v ? Merger{u, v, p, error, tie} : Merger{v, u, p, error, tie};
}

bool OptimalRule::prepare(Index u, Index v, bool slivers) {
  const Merger m = prepared_ = merge(u, v);
  return mesh_.keeps_topology(m.removed, m.kept) && mesh_.keeps_faces(m.removed, m.kept, m.position, slivers) &&
         (m.position == mesh_.point(m.kept).position() || mesh_.keeps_faces(m.kept, m.removed, m.position, slivers));
}

OptimalRule::Outcome OptimalRule::collapse() {
  const Merger& m = prepared_;
  auto& kept = mesh_.vertex(m.kept);
  auto& at = mesh_.point(m.kept);
  kept.quadric = kept.quadric.about(m.position - at.position());
  kept.quadric += mesh_.vertex(m.removed).quadric.about(m.position - mesh_.point(m.removed).position());
  if (m.position != at.position()) kept.set(Mesh::kMoved);
  at = {m.position.x(), m.position.y(), m.position.z(), m.error};
  kept.stamp = ++clock_;
  if (!weight_.empty()) weight_[m.kept] = std::max(weight_[m.kept], weight_[m.removed]);
  return {mesh_.collapse(m.removed, m.kept), m.kept, false};
}

}  // namespace

ManifoldMesh collapse_into_optimum(ManifoldMesh&& mesh, const SimplifyTarget& target, const QuadricCollapse& options,
                                   const RunContext& context) {
  return run_collapse<OptimalRule>(std::move(mesh), target, options, context);
}

}  // namespace shapelight::simplification
