#include "shapelight/features/shape_index.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "graph/field_checks.hpp"

namespace shapelight {
namespace {

// The curvature below which a vertex counts as flat; [1 / input length unit].
double regularisation(const SurfaceGraph& graph, const Curvatures& curvatures, double sigma,
                      const ShapeIndexOptions& options) {
  std::vector<double> bends(graph.size());
  for (std::size_t i = 0; i < bends.size(); ++i) bends[i] = curvedness(curvatures.k1[i], curvatures.k2[i]);
  const double h = graph.mean_edge_length;
  const double typical = options.curvedness_factor * median(std::move(bends));
  if (!(h > 0.0)) return typical;
  return std::max({options.flatness / h, options.noise_factor * sigma / (h * h), typical});
}

}  // namespace

std::vector<double> compute_shape_index(const SurfaceGraph& graph, const Curvatures& curvatures, double sigma,
                                        const ShapeIndexOptions& options, const RunContext& context) {
  validate_options(options);
  check_field(graph, curvatures.k1, "k1");
  check_field(graph, curvatures.k2, "k2");
  if (!(sigma >= 0.0)) throw InvalidInput(fmt::format("sigma: {}, expected a length >= 0", sigma));

  const double eps = options.form == ShapeIndexForm::Literal ? 0.0 : regularisation(graph, curvatures, sigma, options);
  std::vector<double> index(graph.size());
  parallel::for_chunks(context, graph.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double difference = curvatures.k1[i] - curvatures.k2[i];
      const double opening = std::sqrt(difference * difference + eps * eps);
      // atan2(0, 0) is 0: the value documented for a flat point of the literal form.
      index[i] = 2.0 / std::numbers::pi * std::atan2(curvatures.k1[i] + curvatures.k2[i], opening);  // eq. 2
    }
  });
  return index;
}

}  // namespace shapelight
