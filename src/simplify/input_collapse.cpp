#include "simplify/collapse_loop.hpp"

namespace shapelight::simplification {
namespace {

// Placement::Input: u goes into its neighbour v, which stays where it is. Every vertex keeps its own best target.
class InputRule : public CollapseRule<float> {
 public:
  using CollapseRule::CollapseRule;
  [[nodiscard]] float cost(Index u, Index v) const;
  // Is the key of u still the cost of its target? The target may have grown dearer.
  [[nodiscard]] bool is_exact(Index u) const { return cost(u, mesh_.vertex(u).target) == mesh_.vertex(u).key; }
  // May u go into v? If so, collapse() does it.
  [[nodiscard]] bool prepare(Index u, Index v, bool slivers);
  Outcome collapse();

 private:
  Index removed_ = kNoIndex, kept_ = kNoIndex;
};

float InputRule::cost(Index u, Index v) const {
  const auto& from = mesh_.vertex(u);
  // Along its line only; a locked vertex is next to nobody.
  if ((from.flags & (Mesh::kLocked | Mesh::kLine)) && !mesh_.is_next_on_line(u, v)) return kNever;
  const Eigen::Vector3f d = mesh_.point(v).position() - mesh_.point(u).position();
  const float rise = mesh_.point(u).error + from.quadric.rise(d);
  const float error =
      std::max(rise, 0.0f) + mesh_.point(v).error + kLengthPenalty * from.quadric.trace() * d.squaredNorm();
  return weight_.empty() ? error : weighted(error, weight_[u]);
}

bool InputRule::prepare(Index u, Index v, bool slivers) {
  removed_ = u;
  kept_ = v;
  return mesh_.keeps_topology(u, v) && mesh_.keeps_faces(u, v, mesh_.point(v).position(), slivers);
}

InputRule::Outcome InputRule::collapse() {
  const Index u = removed_, v = kept_;
  const Eigen::Vector3f d = mesh_.point(v).position() - mesh_.point(u).position();
  const Quadric<float>& gone = mesh_.vertex(u).quadric;
  mesh_.point(v).error += std::max(mesh_.point(u).error + gone.rise(d), 0.0f);
  mesh_.vertex(v).quadric += gone.about(d);
  return {mesh_.collapse(u, v), v, true};
}

}  // namespace

ManifoldMesh collapse_into_input(ManifoldMesh&& mesh, const SimplifyTarget& target, const QuadricCollapse& options,
                                 const RunContext& context) {
  return run_collapse<InputRule>(std::move(mesh), target, options, context);
}

}  // namespace shapelight::simplification
