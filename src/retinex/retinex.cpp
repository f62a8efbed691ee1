#include "shapelight/retinex/retinex.hpp"

#include <algorithm>
#include <cmath>

#include "core/exponential.hpp"
#include "core/parallel.hpp"
#include "graph/field_checks.hpp"
#include "graph/ring_chunk.hpp"

namespace shapelight {
namespace {

constexpr double kSigmaOfOnePass = 3.0;  // [mean edge lengths] what four rings can hold
constexpr float kLargestExponent = 40.0f;

// What the bilateral mean reads of a vertex, in one place and in units that make the exponent a plain squared distance:
// lengths over sqrt(2) sigma_d (eq. 6), intensity over sqrt(2) sigma_r (eq. 7).
struct alignas(32) Site {
  float x, y, z, value, area, intensity;
};

std::vector<Site> make_sites(const SurfaceGraph& graph, double length_scale) {
  std::vector<Site> sites(graph.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Vec3 p = graph.position[i] * length_scale;
    sites[i] = {static_cast<float>(p.x()),
                static_cast<float>(p.y()),
                static_cast<float>(p.z()),
                0.0f,
                static_cast<float>(graph.area[i] / graph.total_area),
                0.0f};
  }
  return sites;
}

// Eq. 4 and 5 over `support`, whose first element is the vertex itself.
class BilateralMean {
 public:
  explicit BilateralMean(std::size_t limit) : exponent_(limit), area_(limit), intensity_(limit) {}

  double operator()(std::span<const Site> sites, std::span<const Index> support) {
    const Site& center = sites[support.front()];
    for (std::size_t k = 0; k < support.size(); ++k) {
      const Site& s = sites[support[k]];
      const float dx = s.x - center.x, dy = s.y - center.y, dz = s.z - center.z, dv = s.value - center.value;
      exponent_[k] = dx * dx + dy * dy + dz * dz + dv * dv;
      area_[k] = s.area;
      intensity_[k] = s.intensity;
    }
    const std::size_t count = support.size();
    for (std::size_t k = 0; k < count; ++k) area_[k] *= exp_minus(std::min(exponent_[k], kLargestExponent));
    // Deviations from the centre, so that a constant field stays exactly what it is.
    double sum = 0.0, total = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      sum += static_cast<double>(area_[k] * (intensity_[k] - center.intensity));
      total += static_cast<double>(area_[k]);
    }
    return total > 0.0 ? sum / total : 0.0;
  }

 private:
  std::vector<float> exponent_, area_, intensity_;
};

void bilateral_pass(const SurfaceGraph& graph, const RetinexOptions& options, std::vector<Site>& sites,
                    std::vector<double>& illumination, const RunContext& context) {
  const double value_scale = 1.0 / (std::sqrt(2.0) * options.range_sigma);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    sites[i].value = static_cast<float>(illumination[i] * value_scale);
    sites[i].intensity = static_cast<float>(illumination[i]);
  }
  const auto limit = static_cast<std::size_t>(options.max_neighbors) + 1;
  parallel::for_chunks(
      context, graph.size(),
      [&](std::size_t begin, std::size_t end) {
        RingCollector rings(graph);
        BilateralMean mean(limit);
        for (std::size_t i = begin; i < end; ++i) {
          illumination[i] += mean(sites, rings.collect(static_cast<Index>(i), options.rings, limit));
        }
      },
      ring_chunk(graph));
}

}  // namespace

RetinexResult decompose_retinex(const SurfaceGraph& graph, std::span<const double> field, const RetinexOptions& options,
                                const RunContext& context) {
  validate_options(options);
  check_field(graph, field, "field", -1.0, 1.0);
  const std::size_t n = graph.size();
  RetinexResult result{std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) result.illumination[i] = 0.5 * (field[i] + 1.0);

  if (graph.mean_edge_length > 0.0 && graph.total_area > 0.0) {
    const double share = options.spatial_sigma / kSigmaOfOnePass;
    const int passes = std::max(1, static_cast<int>(std::ceil(share * share - 1e-9)));
    const double sigma = options.spatial_sigma * graph.mean_edge_length / std::sqrt(passes);
    std::vector<Site> sites = make_sites(graph, 1.0 / (std::sqrt(2.0) * sigma));
    for (int pass = 0; pass < passes; ++pass) bilateral_pass(graph, options, sites, result.illumination, context);
  }
  for (std::size_t i = 0; i < n; ++i) {
    result.illumination[i] = std::clamp(result.illumination[i], 0.0, 1.0);
    result.reflectance[i] = std::log1p(0.5 * (field[i] + 1.0)) - std::log1p(result.illumination[i]);  // eq. 8
  }
  return result;
}

}  // namespace shapelight
