#include "shapelight/features/curvature.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "core/tangent_frame.hpp"
#include "features/local_fit.hpp"
#include "graph/ring_chunk.hpp"

namespace shapelight {
namespace {

bool has_normal(const SurfaceGraph& graph, std::size_t i) { return !graph.normal[i].isZero(0.0); }

// Share of the even-ring weight that keeps directions the ring does not see at no deviation.
constexpr double kRidge = 0.02;

// Euler's theorem: the normal curvature at angle t is mean + re cos 2t + im sin 2t; fitted to the edges by weighted
// least squares. Over a ring with even directions the normal matrix is diag(1, 1/2, 1/2), and the solution is Taubin's
// k1 = 3 m1 - m2, k2 = 3 m2 - m1 in closed form; over an uneven one Taubin's means are biased and this is not.
TangentTensor taubin_tensor(const SurfaceGraph& graph, std::size_t i, const TangentFrame& frame) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (std::uint32_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
    const Vec3 d = graph.position[graph.neighbors[e]] - graph.position[i];
    const double x = d.dot(frame.x), y = d.dot(frame.y);
    const double tangential_sq = x * x + y * y;
    if (tangential_sq == 0.0) continue;
    const double directional = -2.0 * d.dot(graph.normal[i]) / d.squaredNorm();
    const Vec3 row(1.0, (x * x - y * y) / tangential_sq, 2.0 * x * y / tangential_sq);
    const double w = static_cast<double>(graph.weight[e]);
    matrix.noalias() += (w * row) * row.transpose();
    right += w * directional * row;
  }
  if (!(matrix(0, 0) > 0.0)) return {};
  const double ridge = 0.5 * kRidge * matrix(0, 0);
  matrix(1, 1) += ridge;
  matrix(2, 2) += ridge;
  const Vec3 fit = matrix.llt().solve(right);
  return {fit[0], fit[1], fit[2], fit.allFinite()};
}

std::vector<TangentTensor> initial_tensors(const SurfaceGraph& graph, const CurvatureOptions& options,
                                           const RunContext& context) {
  std::vector<TangentTensor> tensors(graph.size());
  const auto count = static_cast<std::size_t>(options.neighbors);
  parallel::for_chunks(
      context, graph.size(),
      [&](std::size_t begin, std::size_t end) {
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
      },
      ring_chunk(graph));
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
