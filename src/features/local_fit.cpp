#include "features/local_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace shapelight {
namespace {

constexpr std::size_t kMostCandidates = 96;  // the 2-ring of a 12-nearest-neighbour graph has about 45 vertices

Vec3 local_offset(const SurfaceGraph& graph, Index center, const TangentFrame& frame, Index other) {
  const Vec3 d = graph.position[other] - graph.position[center];
  return {d.dot(frame.x), d.dot(frame.y), d.dot(graph.normal[center])};
}

// Inverse square root of a symmetric positive definite 2x2 matrix: with s = sqrt(det), t = sqrt(trace + 2 s) the
// square root is (M + s I) / t.
Eigen::Matrix2d inverse_sqrt(const Eigen::Matrix2d& m) {
  const double s = std::sqrt(m.determinant());
  const double t = std::sqrt(m.trace() + 2.0 * s);
  return ((m + s * Eigen::Matrix2d::Identity()) / t).inverse();
}

}  // namespace

std::span<const Index> NearestOfRings::find(Index center, std::size_t count) {
  const auto found = rings_.collect(center, 2, kMostCandidates).subspan(1);
  if (found.size() <= count) return found;
  by_distance_.clear();
  for (const Index j : found) {
    by_distance_.emplace_back((graph_->position[j] - graph_->position[center]).squaredNorm(), j);
  }
  std::nth_element(by_distance_.begin(), by_distance_.begin() + static_cast<std::ptrdiff_t>(count), by_distance_.end());
  nearest_.resize(count);
  for (std::size_t k = 0; k < count; ++k) nearest_[k] = by_distance_[k].second;
  // A fixed order of summation, whatever nth_element of this standard library does.
  std::sort(nearest_.begin(), nearest_.end());
  return nearest_;
}

QuadricFit fit_quadric(const SurfaceGraph& graph, Index center, const TangentFrame& frame,
                       std::span<const Index> others, FitWeight weight) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  QuadricFit fit;
  double sum_sq = 0.0, farthest_sq = 0.0;
  for (const Index j : others) {
    const double distance_sq = (graph.position[j] - graph.position[center]).squaredNorm();
    sum_sq += distance_sq;
    farthest_sq = std::max(farthest_sq, distance_sq);
  }
  fit.scale = std::sqrt(sum_sq / static_cast<double>(others.size()));
  // exp(-d^2 / (2 s^2)) with s^2 = r^2 / 4, r being the distance of the farthest vertex.
  const double decay = weight == FitWeight::Gaussian ? 2.0 * fit.scale * fit.scale / farthest_sq : 0.0;

  Matrix6 normal_matrix = Matrix6::Zero();
  normal_matrix(0, 0) = 1.0;  // the centre itself, at height 0
  Vector6 right = Vector6::Zero();
  for (const Index j : others) {
    const Vec3 p = local_offset(graph, center, frame, j) / fit.scale;
    const double w = decay > 0.0 ? std::exp(-decay * p.squaredNorm()) : 1.0;
    Vector6 row;
    row << 1.0, p.x(), p.y(), 0.5 * p.x() * p.x(), p.x() * p.y(), 0.5 * p.y() * p.y();
    normal_matrix.noalias() += (w * row) * row.transpose();
    right += (w * p.z()) * row;
  }
  normal_matrix.diagonal().array() += 1e-9 * normal_matrix.trace();
  const Eigen::LLT<Matrix6> solver(normal_matrix);
  fit.coefficients = solver.solve(right);
  fit.leverage = solver.solve(Vector6(Vector6::Unit(0)))[0];
  return fit;
}

TangentTensor shape_operator(const QuadricFit& fit) {
  const auto& c = fit.coefficients;
  Eigen::Matrix2d first, second;
  first << 1.0 + c[1] * c[1], c[1] * c[2], c[1] * c[2], 1.0 + c[2] * c[2];
  second << c[3], c[4], c[4], c[5];
  const Eigen::Matrix2d root = inverse_sqrt(first);
  const double slope = std::sqrt(1.0 + c[1] * c[1] + c[2] * c[2]);
  // A dome lies below its tangent plane, hence the sign.
  const Eigen::Matrix2d shape = root * second * root / (-slope * fit.scale);
  return {0.5 * (shape(0, 0) + shape(1, 1)), 0.5 * (shape(0, 0) - shape(1, 1)), shape(0, 1), shape.allFinite()};
}

TangentTensor fit_normal_field(const SurfaceGraph& graph, Index center, const TangentFrame& frame,
                               std::span<const Index> others) {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  Vec3 right = Vec3::Zero();
  for (const Index j : others) {
    const double along = graph.normal[j].dot(graph.normal[center]);
    if (along <= 0.0) continue;
    const double w = along * along;
    const Vec3 p = local_offset(graph, center, frame, j);
    const double u = graph.normal[j].dot(frame.x), v = graph.normal[j].dot(frame.y);
    xx += w * p.x() * p.x();
    xy += w * p.x() * p.y();
    yy += w * p.y() * p.y();
    right += w * Vec3(p.x() * u, p.y() * u + p.x() * v, p.y() * v);
  }
  const double trace = xx + yy;
  if (!(xx * yy - xy * xy > 1e-9 * trace * trace)) return {};
  // a x + b y = u, b x + d y = v for S = [[a, b], [b, d]].
  Eigen::Matrix3d m;
  m << xx, xy, 0.0, xy, trace, xy, 0.0, xy, yy;
  const Vec3 s = m.llt().solve(right);
  return {0.5 * (s[0] + s[2]), 0.5 * (s[0] - s[2]), s[1], s.allFinite()};
}

}  // namespace shapelight
