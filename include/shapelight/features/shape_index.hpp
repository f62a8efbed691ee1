#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/features/curvature.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

enum class ShapeIndexForm : std::uint8_t { Regularised, Literal };

[[nodiscard]] constexpr auto enum_names(ShapeIndexForm) {
  return std::array<std::pair<ShapeIndexForm, std::string_view>, 2>{
      {{ShapeIndexForm::Regularised, "regularised"}, {ShapeIndexForm::Literal, "literal"}}};
}

/// Parameters of compute_shape_index().
struct ShapeIndexOptions {
  ShapeIndexForm form = ShapeIndexForm::Regularised;
  double curvedness_factor = 3.0;  ///< [1] of the median curvedness; 0 makes the index blind to scale
  double noise_factor = 1.5;       ///< [1] of sigma / h^2, the curvature that noise alone feigns
  double flatness = 0.02;          ///< [1] of 1 / h: curvature that counts as flat

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"shape-index", "", "Regularised, or the paper's literal equation 2.", 0, 0}, o.form);
    visit(OptionInfo{"curvedness-factor", "1", "Share of the median curvedness in the regularisation.", 0, 100},
          o.curvedness_factor);
    visit(OptionInfo{"noise-factor", "1", "Share of sigma / h^2 in the regularisation.", 0, 100}, o.noise_factor);
    visit(OptionInfo{"flatness", "1", "Share of 1 / h in the regularisation.", 0, 10}, o.flatness);
  }
};

/// Shape index per vertex (Koenderink; eq. 2 of the paper): -1 cup, -0.5 rut, 0 saddle, 0.5 ridge, 1 dome.
///
/// - Literal: s = (2 / pi) arctan((k1 + k2) / (k1 - k2)), eq. 2 with this library's signs (convex is positive).
///   Umbilic points, where the paper divides by zero, get the limit +-1; flat ones, 0 / 0, get 0.
/// - Regularised: s = (2 / pi) atan2(k1 + k2, sqrt((k1 - k2)^2 + eps^2)) with
///   eps = max(flatness / h, noise_factor sigma / h^2, curvedness_factor x median curvedness): flat means 0, never a
///   random sign, and |s| grows with the curvedness, so a pimple weighs less than a dome.
/// Pre:   curvatures have the graph's size and are finite; sigma [input length unit] >= 0.
/// Post:  values in [-1, 1]; unchanged by rigid motion and, sigma scaled along, by scale.
/// Throws InvalidInput (names option or vertex), Cancelled.
/// Cost:  O(n), about 0.05 us per vertex. Support: pointwise, but for the global h and median.
[[nodiscard]] std::vector<double> compute_shape_index(const SurfaceGraph& graph, const Curvatures& curvatures,
                                                      double sigma, const ShapeIndexOptions& options = {},
                                                      const RunContext& context = {});

}  // namespace shapelight
