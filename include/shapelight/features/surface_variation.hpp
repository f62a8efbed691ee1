#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

enum class SurfaceVariationMethod : std::uint8_t { Nearest, Diffusion };

[[nodiscard]] constexpr auto enum_names(SurfaceVariationMethod) {
  return std::array<std::pair<SurfaceVariationMethod, std::string_view>, 2>{
      {{SurfaceVariationMethod::Nearest, "nearest"}, {SurfaceVariationMethod::Diffusion, "diffusion"}}};
}

/// Parameters of compute_surface_variation().
struct SurfaceVariationOptions {
  SurfaceVariationMethod method = SurfaceVariationMethod::Nearest;
  int neighbors = 30;  ///< [points] size of the neighbourhood, the vertex itself included

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"variation-method", "", "How the points around a vertex are gathered.", 0, 0}, o.method);
    visit(OptionInfo{"variation-neighbors", "points", "Neighbourhood of the surface variation.", 6, 1000}, o.neighbors);
  }
};

/// Surface variation l0 / (l0 + l1 + l2) per vertex (Pauly), l0 <= l1 <= l2 being the eigenvalues of the covariance of
/// the points around it: 0 on a plane, at most 1/3.
///
/// - Nearest: the `neighbors` nearest vertices, by a kd-tree. Follows the surface however the mesh is cut.
/// - Diffusion: no search; the first and second moments of the positions are averaged over the 1-ring
///   neighbors / (mean degree + 1) times, which weighs the points around a vertex by a bell about as wide as their
///   disk. Rank correlation with Nearest at 30: 0.93 to 0.98 on 12-nearest-neighbour clouds (2 passes); on meshes (4
///   passes) 0.81 to 0.94, and below 0.6 where triangles are slivers.
/// Pre:   as SurfaceGraph promises.
/// Post:  values in [0, 1/3]; 0 for an isolated vertex; unchanged by rigid motion and scale.
/// Throws InvalidInput (option out of range), Cancelled.
/// Cost:  Nearest O(n log n), about 2 us per vertex and 30 n bytes beyond the result; Diffusion O(passes x edges),
/// about
///        0.4 us and 160 n bytes. Support: the neighbours, or `passes` rings.
[[nodiscard]] std::vector<double> compute_surface_variation(const SurfaceGraph& graph,
                                                            const SurfaceVariationOptions& options = {},
                                                            const RunContext& context = {});

}  // namespace shapelight
