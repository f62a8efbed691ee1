#include "shapelight/features/surface_variation.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight {
namespace {

// Mean of (x, y, z, xx, xy, xz, yy, yz, zz, 0): even, so that two-lane vectors fit.
using Moments = Eigen::Array<double, 10, 1>;

Moments moments_of(const Vec3& p) {
  Moments m;
  m << p.x(), p.y(), p.z(), p.x() * p.x(), p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z(),
      0.0;
  return m;
}

template <class MomentsAt>
std::vector<Moments> averaged(const SurfaceGraph& graph, MomentsAt&& moments_at, const RunContext& context) {
  std::vector<Moments> result(graph.size());
  parallel::for_chunks(context, graph.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Moments sum = moments_at(i);
      for (const Index j : graph.neighbors_of(i)) sum += moments_at(j);
      result[i] = sum / static_cast<double>(graph.neighbors_of(i).size() + 1);
    }
  });
  return result;
}

// Smallest root of the characteristic polynomial x^3 - t x^2 + c x - d of a positive semi-definite matrix. Left of that
// root the polynomial rises and is concave, so Newton's steps from 0 climb to it without ever passing it; a small root
// keeps its relative precision, which closed forms by trigonometry lose.
double smallest_eigenvalue(double t, double c, double d) {
  double x = 0.0;
  for (int step = 0; step < 64; ++step) {
    const double value = ((x - t) * x + c) * x - d;
    const double slope = (3.0 * x - 2.0 * t) * x + c;
    if (!(value < 0.0 && slope > 0.0)) break;
    const double next = x - value / slope;
    if (next - x <= 1e-12 * next) return next;
    x = next;
  }
  return x;
}

double variation_of(const Moments& m) {
  const double xx = m[3] - m[0] * m[0], xy = m[4] - m[0] * m[1], xz = m[5] - m[0] * m[2];
  const double yy = m[6] - m[1] * m[1], yz = m[7] - m[1] * m[2], zz = m[8] - m[2] * m[2];
  const double trace = xx + yy + zz;
  if (!(trace > 0.0)) return 0.0;
  const double minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
  const double determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  return std::clamp(smallest_eigenvalue(trace, minors, determinant) / trace, 0.0, 1.0 / 3.0);
}

std::vector<double> variation_by_diffusion(const SurfaceGraph& graph, int neighbors, const RunContext& context) {
  const auto n = static_cast<double>(std::max<std::size_t>(1, graph.size()));
  const double ring = static_cast<double>(graph.neighbors.size()) / n + 1.0;
  const int passes = std::max(1, static_cast<int>(std::lround(neighbors / ring)));

  std::vector<Moments> moments = averaged(
      graph, [&](std::size_t i) { return moments_of(graph.position[i]); }, context);
  for (int pass = 1; pass < passes; ++pass) {
    moments = averaged(
        graph, [&](std::size_t i) -> const Moments& { return moments[i]; }, context);
  }
  std::vector<double> variation(graph.size());
  parallel::for_chunks(context, graph.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) variation[i] = variation_of(moments[i]);
  });
  return variation;
}

std::vector<double> variation_of_nearest(const SurfaceGraph& graph, int neighbors, const RunContext& context) {
  const auto others = static_cast<std::size_t>(neighbors - 1);  // the point itself is one of them
  const std::vector<Index> nearest = KdTree(graph.position, context).all_nearest(others, context);
  std::vector<double> variation(graph.size());
  parallel::for_chunks(context, graph.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (graph.neighbors_of(i).empty()) continue;
      Moments sum = Moments::Zero();  // about the point itself, which adds nothing
      double count = 1.0;
      for (std::size_t k = i * others; k < (i + 1) * others && nearest[k] != kNoIndex; ++k) {
        sum += moments_of(graph.position[nearest[k]] - graph.position[i]);
        count += 1.0;
      }
      variation[i] = variation_of(sum / count);
    }
  });
  return variation;
}

}  // namespace

std::vector<double> compute_surface_variation(const SurfaceGraph& graph, const SurfaceVariationOptions& options,
                                              const RunContext& context) {
  validate_options(options);
  return options.method == SurfaceVariationMethod::Nearest ? variation_of_nearest(graph, options.neighbors, context)
                                                           : variation_by_diffusion(graph, options.neighbors, context);
}

}  // namespace shapelight
