#include <fmt/format.h>

#include <limits>

#include "shapelight/core/error.hpp"
#include "shapelight/simplify/ssim.hpp"
#include "simplify/quadric_collapse.hpp"

namespace shapelight {

SimplifiedMesh simplify_ssim_paper(const TriangleMesh& mesh, const SimplifyTarget& target,
                                   std::span<const Index> samples, const FeatureEdges& features,
                                   const RunContext& context, MeshOddities* oddities) {
  std::vector<std::uint8_t> is_sample(mesh.positions.size(), 0);
  for (const Index v : samples) {
    if (v >= is_sample.size()) {
      throw InvalidInput(fmt::format("ssim-paper: sample {} >= {} vertices", v, is_sample.size()));
    }
    is_sample[v] = 1;
  }
  simplification::ManifoldMesh manifold =
      simplification::make_manifold(mesh, features, context.phase(0.0, 0.2, "sheets"), oddities);
  std::vector<float> removal_weight(manifold.source.size(), 1.0f);
  for (std::size_t v = 0; v < removal_weight.size(); ++v) {
    if (is_sample[manifold.source[v]]) removal_weight[v] = std::numeric_limits<float>::infinity();
  }
  simplification::QuadricCollapse collapse;
  collapse.removal_weight = removal_weight;
  return simplification::merge_copies(
      simplification::collapse_quadrics(std::move(manifold), target, collapse, context.phase(0.2, 1.0, "collapse")));
}

}  // namespace shapelight
