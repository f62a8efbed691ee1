#include "shapelight/features/curvature.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "core/tangent_frame.hpp"
#include "features/local_fit.hpp"

namespace shapelight {
namespace {

bool has_normal(const SurfaceGraph& graph, std::size_t i) { return !graph.normal[i].isZero(0.0); }

// Taubin's tensor in closed form. A tangent direction at angle t has t t' = (I + [[cos 2t, sin 2t], [sin 2t, -cos 2t]]) / 2,
// so M = sum w k t t' has m1 + m2 = sum w k, and the tensor with k1 = 3 m1 - m2, k2 = 3 m2 - m1 is 4 M - (m1 + m2) I.
TangentTensor taubin_tensor(const SurfaceGraph& graph, std::size_t i, const TangentFrame& frame) {
  TangentTensor sum;
  double total = 0.0;
  for (std::uint32_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
    const Vec3 d = graph.position[graph.neighbors[e]] - graph.position[i];
    const double x = d.dot(frame.x), y = d.dot(frame.y);
    const double tangential_sq = x * x + y * y;
    if (tangential_sq == 0.0) continue;
    const double directional = -2.0 * d.dot(graph.normal[i]) / d.squaredNorm();
    const double w = static_cast<double>(graph.weight[e]);
    total += w;
    sum.mean += w * directional;
    sum.re += w * directional * (x * x - y * y) / tangential_sq;
    sum.im += w * directional * 2.0 * x * y / tangential_sq;
  }
  if (total == 0.0) return {};
  return {sum.mean / total, 2.0 * sum.re / total, 2.0 * sum.im / total, true};
}

std::vector<TangentTensor> initial_tensors(const SurfaceGraph& graph, const CurvatureOptions& options,
                                           const RunContext& context) {
  std::vector<TangentTensor> tensors(graph.size());
  const auto count = static_cast<std::size_t>(options.neighbors);
  parallel::for_chunks(context, graph.size(), [&](std::size_t begin, std::size_t end) {
    NearestOfRings nearest(graph);
    for (std::size_t i = begin; i < end; ++i) {
      if (!has_normal(graph, i)) continue;
      const auto center = static_cast<Index>(i);
      const TangentFrame frame = tangent_frame(graph.normal[i]);
      if (options.method == CurvatureMethod::Taubin) {
        tensors[i] = taubin_tensor(graph, i, frame);
        continue;
      }
      const auto others = nearest.find(center, count);
      if (others.size() < 3) continue;
      tensors[i] = options.method == CurvatureMethod::Quadric
                       ? shape_operator(fit_quadric(graph, center, frame, others, FitWeight::Gaussian))
                       : fit_normal_field(graph, center, frame, others);
    }
  });
  return tensors;
}

// Mean of the tensors of a vertex and its 1-ring, each carried over by the smallest rotation between the normals.
TangentTensor smoothed_tensor(const SurfaceGraph& graph, std::span<const TangentTensor> tensors, std::size_t i) {
  const Vec3& n = graph.normal[i];
  const TangentFrame frame = tangent_frame(n);
  TangentTensor sum;
  double total = 0.0;
  const auto add = [&](double w, const TangentTensor& t, double re, double im) {
    total += w;
    sum.mean += w * t.mean;
    sum.re += w * re;
    sum.im += w * im;
  };
  if (tensors[i].defined) add(graph.area[i], tensors[i], tensors[i].re, tensors[i].im);
  for (const Index j : graph.neighbors_of(i)) {
    const TangentTensor& t = tensors[j];
    const double along = n.dot(graph.normal[j]);
    if (!t.defined || along <= 0.0) continue;
    // Rotating v, perpendicular to n_j, by the smallest turn of n_j into n gives v - (n.v) (n_j + n) / (1 + n_j.n).
    const Vec3 v = tangent_frame(graph.normal[j]).x;
    const double share = n.dot(v) / (1.0 + along);
    const double c = frame.x.dot(v) - share * frame.x.dot(graph.normal[j]);
    const double s = frame.y.dot(v) - share * frame.y.dot(graph.normal[j]);
    const double c2 = c * c - s * s, s2 = 2.0 * c * s;
    add(graph.area[j] * along * along, t, c2 * t.re - s2 * t.im, s2 * t.re + c2 * t.im);
  }
  if (total == 0.0) return tensors[i];
  return {sum.mean / total, sum.re / total, sum.im / total, true};
}

void smooth(const SurfaceGraph& graph, std::vector<TangentTensor>& tensors, const RunContext& context) {
  std::vector<TangentTensor> smoothed(tensors.size());
  parallel::for_chunks(context, graph.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (has_normal(graph, i)) smoothed[i] = smoothed_tensor(graph, tensors, i);
    }
  });
  tensors.swap(smoothed);
}

}  // namespace

Curvatures estimate_curvatures(const SurfaceGraph& graph, const CurvatureOptions& options, const RunContext& context) {
  validate_options(options);
  const std::size_t n = graph.size();
  std::vector<TangentTensor> tensors = initial_tensors(graph, options, context);
  for (int pass = 0; pass < options.smoothing_passes; ++pass) smooth(graph, tensors, context);

  Curvatures result{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0), std::vector<Vec3>(n, Vec3::Zero())};
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const TangentTensor& t = tensors[i];
      if (!t.defined) continue;
      const double deviator = std::sqrt(t.re * t.re + t.im * t.im);
      result.k1[i] = t.mean + deviator;
      result.k2[i] = t.mean - deviator;
      // Half of the angle of (re, im), without trigonometry; any direction serves where the two are equal.
      const double c = deviator > 0.0 ? t.re / deviator : 1.0;
      const double half_c = std::sqrt(std::max(0.0, 0.5 * (1.0 + c)));
      const double half_s = std::copysign(std::sqrt(std::max(0.0, 0.5 * (1.0 - c))), t.im);
      const TangentFrame frame = tangent_frame(graph.normal[i]);
      result.direction1[i] = half_c * frame.x + half_s * frame.y;
    }
  });
  return result;
}

}  // namespace shapelight
