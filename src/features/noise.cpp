#include "shapelight/features/noise.hpp"

#include <cmath>
#include <vector>

#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "features/local_fit.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kMostProbes = 16384;
constexpr std::size_t kFitPoints = 12;
constexpr std::size_t kFewestPoints = 8;        // beside the vertex: three more than the quadric has freedoms
constexpr double kMedianOfNormal = 0.67448976;  // median of |x| for a standard normal x
constexpr double kMostLeverage = 0.95;          // beyond this the quadric passes through the vertex anyway

}  // namespace

double estimate_noise(const SurfaceGraph& graph, const RunContext& context) {
  const std::size_t stride = graph.size() / kMostProbes + 1;
  const std::size_t num_probes = (graph.size() + stride - 1) / stride;
  std::vector<double> residuals(num_probes, -1.0);
  parallel::for_chunks(context, num_probes, [&](std::size_t begin, std::size_t end) {
    NearestOfRings nearest(graph);
    for (std::size_t probe = begin; probe < end; ++probe) {
      const auto i = static_cast<Index>(probe * stride);
      if (graph.normal[i].isZero(0.0)) continue;
      const auto others = nearest.find(i, kFitPoints);
      if (others.size() < kFewestPoints) continue;
      const QuadricFit fit = fit_quadric(graph, i, tangent_frame(graph.normal[i]), others, FitWeight::Unit);
      if (!(fit.leverage < kMostLeverage)) continue;
      residuals[probe] = std::abs(fit.coefficients[0]) * fit.scale / std::sqrt(1.0 - fit.leverage);
    }
  });
  std::erase_if(residuals, [](double r) { return !(r >= 0.0); });
  return median(std::move(residuals)) / kMedianOfNormal;
}

}  // namespace shapelight
