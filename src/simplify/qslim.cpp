#include "shapelight/simplify/qslim.hpp"

#include "simplify/quadric_collapse.hpp"

namespace shapelight {

SimplifiedMesh simplify_qslim(const TriangleMesh& mesh, const SimplifyTarget& target, const QslimOptions& options,
                              const FeatureEdges& features, const RunContext& context, MeshOddities* oddities) {
  validate_options(options);
  simplification::QuadricCollapse collapse;
  collapse.placement = options.placement;
  collapse.boundary_weight = options.boundary_weight;
  simplification::ManifoldMesh manifold =
      simplification::make_manifold(mesh, features, context.phase(0.0, 0.2, "sheets"), oddities);
  return simplification::merge_copies(
      simplification::collapse_quadrics(std::move(manifold), target, collapse, context.phase(0.2, 1.0, "collapse")));
}

}  // namespace shapelight
