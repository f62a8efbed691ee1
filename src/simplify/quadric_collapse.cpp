#include "simplify/quadric_collapse.hpp"

#include "shapelight/core/error.hpp"
#include "simplify/collapse_rule.hpp"

namespace shapelight::simplification {

ManifoldMesh collapse_quadrics(ManifoldMesh&& mesh, const SimplifyTarget& target, const QuadricCollapse& options,
                               const RunContext& context) {
  if ((target.vertices == 0) == (target.faces == 0)) {
    throw InvalidInput("simplify: expected exactly one target, of vertices or of faces");
  }
  const auto collapse = options.placement == Placement::Input ? collapse_into_input : collapse_into_optimum;
  return collapse(std::move(mesh), target, options, context);
}

}  // namespace shapelight::simplification
