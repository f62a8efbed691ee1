#include "shapelight/sample/covariance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>

#include "core/parallel.hpp"
#include "sample/candidates.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Vertices as point-to-plane constraints (p x n, n), with p centred and of unit mean radius.
std::vector<Vec6> constraints(const SurfaceGraph& graph, std::span<const Index> candidates, const RunContext& context) {
  const std::size_t n = candidates.size();
  Vec3 center = Vec3::Zero();
  for (const Index vertex : candidates) center += graph.position[vertex];
  center /= static_cast<double>(n);
  const double radius =
      parallel::sum(context, n, [&](std::size_t i) { return (graph.position[candidates[i]] - center).norm(); }) /
      static_cast<double>(n);
  const double scale = radius > 0.0 ? 1.0 / radius : 1.0;
  std::vector<Vec6> constraint(n);
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& normal = graph.normal[candidates[i]];
      constraint[i] << ((graph.position[candidates[i]] - center) * scale).cross(normal), normal;
    }
  });
  return constraint;
}

/// Replaces each constraint v by (v . x_k)^2 for the six eigenvectors x_k of sum v v'.
void project_onto_motions(std::vector<Vec6>& constraint, const RunContext& context) {
  const Mat6 covariance = parallel::reduce_chunks(
      context, constraint.size(), Mat6(Mat6::Zero()),
      [&](std::size_t begin, std::size_t end) {
        Mat6 part = Mat6::Zero();
        for (std::size_t i = begin; i < end; ++i) part += constraint[i] * constraint[i].transpose();
        return part;
      },
      [](const Mat6& a, const Mat6& b) { return Mat6(a + b); });
  const Mat6 motions = Eigen::SelfAdjointEigenSolver<Mat6>(covariance).eigenvectors();
  parallel::for_chunks(context, constraint.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      constraint[i] = (motions.transpose() * constraint[i]).cwiseAbs2().eval();
    }
  });
}

/// Slots by falling resistance to one motion. Never more than `count` slots of a list are looked at, so it is cut
/// there.
std::vector<Index> strongest(const std::vector<Vec6>& resistance, int motion, std::size_t count) {
  std::vector<Index> slots(resistance.size());
  std::iota(slots.begin(), slots.end(), Index{0});
  auto stronger = [&](Index a, Index b) {
    const double value_a = resistance[a][motion];
    const double value_b = resistance[b][motion];
    return value_a > value_b || (value_a == value_b && a < b);
  };
  const auto end = slots.begin() + static_cast<std::ptrdiff_t>(count);
  if (end != slots.end()) std::nth_element(slots.begin(), end, slots.end(), stronger);
  std::sort(slots.begin(), end, stronger);
  slots.resize(count);
  return slots;
}

}  // namespace

std::vector<Index> sample_covariance(const SurfaceGraph& graph, std::span<const Index> candidates,
                                     const SamplingTarget& target, const CovarianceSamplingOptions&,
                                     const RunContext& context) {
  check_sampling(graph, candidates, target);
  require_count(target, "covariance");
  if (std::all_of(candidates.begin(), candidates.end(), [&](Index v) { return graph.normal[v].isZero(0.0); })) {
    throw InvalidInput("sampling method covariance: no point has a normal, expected at least one");
  }
  context.report(0.0, "covariance sampling");
  std::vector<Vec6> resistance = constraints(graph, candidates, context);
  project_onto_motions(resistance, context);
  std::array<std::vector<Index>, 6> lists;
  parallel::for_chunks(
      context, lists.size(),
      [&](std::size_t begin, std::size_t) {
        lists[begin] = strongest(resistance, static_cast<int>(begin), target.count);
      },
      1);
  context.report(0.5, "covariance sampling");

  std::vector<Index> chosen;
  std::vector<std::uint8_t> used(candidates.size(), 0);
  std::array<std::size_t, 6> next{};
  Vec6 total = Vec6::Zero();  // resistance of the sample so far
  while (chosen.size() < target.count) {
    int weakest = 0;
    total.minCoeff(&weakest);
    while (used[lists[weakest][next[weakest]]]) ++next[weakest];
    const Index slot = lists[weakest][next[weakest]];
    used[slot] = 1;
    total += resistance[slot];
    chosen.push_back(slot);
  }
  to_vertices(candidates, chosen);
  context.report(1.0, "covariance sampling");
  return chosen;
}

}  // namespace shapelight
