#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"
#include "registration/thin_scan.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/registration/coarse_alignment.hpp"

namespace shapelight {
namespace {

constexpr double kPoints = 4000;         // of a thinned scan: enough for detail, few enough to describe them all
constexpr double kSpacings = 2.0;        // of the scan at least: several points share a cell
constexpr std::size_t kProbe = 40000;    // points that say how many cells are occupied
constexpr double kRadius = 5.0;          // [spacings] of a neighbourhood: about 80 points
constexpr std::size_t kKeypoints = 600;  // more find no more poses, but cost
constexpr double kFinest = 1e-6;         // [diagonals] cells are numbered with 21 bits per axis
constexpr std::size_t kChunk = 256;

constexpr std::size_t kBinsPerAngle = DescribedPoints::kBins / 3;
using Histogram = std::array<float, DescribedPoints::kBins>;

/// Adds to the two bins next to a value in [0, 1], so that a small change of it makes a small change of the histogram.
void add(float* bins, double value) {
  const double place = value * static_cast<double>(kBinsPerAngle) - 0.5;
  const double below = std::floor(place);
  const auto share = static_cast<float>(place - below);
  constexpr int kLast = kBinsPerAngle - 1;
  bins[std::clamp(static_cast<int>(below), 0, kLast)] += 1.0F - share;
  bins[std::clamp(static_cast<int>(below) + 1, 0, kLast)] += share;
}

/// Neighbours of a point, itself and points at its place left out.
std::vector<Neighbor> neighborhood(const KdTree& tree, const Vec3& center, double radius) {
  std::vector<Neighbor> near;
  tree.within(center, radius, near);
  std::erase_if(near, [](const Neighbor& neighbor) { return neighbor.distance_sq == 0.0; });
  return near;
}

/// How the surface bends around a point: three angles of every neighbour's normal in the frame of its own normal u and
/// the direction to the neighbour (Rusu et al. 2009, eq. 1). With all normals turned, the first angle stays and the
/// other two change their sign.
Histogram bending(const ThinnedScan& scan, std::size_t i, std::span<const Neighbor> near) {
  Histogram bins{};
  const Vec3& u = scan.normal[i];
  const float weight = 1.0F / static_cast<float>(std::max<std::size_t>(1, near.size()));
  for (const Neighbor& neighbor : near) {
    const Vec3 direction = (scan.position[neighbor.index] - scan.position[i]) / std::sqrt(neighbor.distance_sq);
    const Vec3& normal = scan.normal[neighbor.index];
    Vec3 v = direction.cross(u);
    const double sine = v.norm();
    if (sine < 1e-6) continue;  // straight above: no frame
    v /= sine;
    const Vec3 w = u.cross(v);
    add(&bins[0], 0.5 * (v.dot(normal) + 1.0));
    add(&bins[kBinsPerAngle], 0.5 * (u.dot(direction) + 1.0));
    add(&bins[2 * kBinsPerAngle], 0.5 * (std::atan2(w.dot(normal), u.dot(normal)) / std::numbers::pi + 1.0));
  }
  for (float& bin : bins) bin *= weight;
  return bins;
}

/// A point's own histogram plus the mean of its neighbours', near ones weighing more (Rusu et al. 2009, eq. 2).
void describe(std::span<const Histogram> bending, std::size_t i, std::span<const Neighbor> near, float* descriptor) {
  Histogram sum{};
  float total = 0.0F;
  if (near.empty()) return;
  const double nearest = near.front().distance_sq;  // any length will do: weights are relative
  for (const Neighbor& neighbor : near) {
    const auto weight = static_cast<float>(std::sqrt(nearest / neighbor.distance_sq));
    total += weight;
    for (std::size_t b = 0; b < sum.size(); ++b) sum[b] += weight * bending[neighbor.index][b];
  }
  for (std::size_t b = 0; b < sum.size(); ++b) descriptor[b] = bending[i][b] + sum[b] / total;
}

/// Points of the thinned scan that keypoints fell into and that have a description, in their order, each once.
std::vector<Index> thinned_keypoints(const ThinnedScan& scan, std::span<const Index> keypoints,
                                     std::span<const std::vector<Neighbor>> near) {
  std::vector<Index> chosen;
  std::vector<std::uint8_t> taken(scan.position.size(), 0);
  for (const Index point : keypoints) {
    const Index i = scan.index_of_point[point];
    if (i == kNoIndex || taken[i] || near[i].empty()) continue;
    taken[i] = 1;
    chosen.push_back(i);
    if (chosen.size() == kKeypoints) break;
  }
  return chosen;
}

void check(const RegistrationCloud& cloud, std::span<const Index> keypoints, double spacing) {
  if (cloud.normal.size() != cloud.size()) throw InvalidInput("describe_points: the cloud has no normals");
  if (!(spacing > 0.0 && std::isfinite(spacing) && spacing >= kFinest * cloud.diagonal)) {
    throw InvalidInput(fmt::format("describe_points: spacing {:g}, expected a positive length, and at least {:g}",
                                   spacing, kFinest * cloud.diagonal));
  }
  for (const Index point : keypoints) {
    if (point >= cloud.size()) {
      throw InvalidInput(fmt::format("describe_points: keypoint {} >= {} points", point, cloud.size()));
    }
  }
}

}  // namespace

double coarse_spacing(const RegistrationCloud& cloud) {
  if (cloud.spacing == 0.0) return 0.0;
  std::vector<Vec3> probe;
  const std::size_t stride = cloud.size() / kProbe + 1;
  for (std::size_t i = 0; i < cloud.size(); i += stride) probe.push_back(cloud.position[i]);
  double cell = cloud.diagonal / std::sqrt(kPoints);
  for (int pass = 0; pass < 4; ++pass) {  // the number of cells of a surface falls with the square of their size
    cell *= std::sqrt(static_cast<double>(count_cells(probe, cell)) / kPoints);
    cell = std::max({cell, kSpacings * cloud.spacing, 2.0 * kFinest * cloud.diagonal});
  }
  return cell;
}

DescribedPoints describe_points(const RegistrationCloud& cloud, std::span<const Index> keypoints, double spacing,
                                const RunContext& context) {
  check(cloud, keypoints, spacing);
  ThinnedScan scan = thin_scan(cloud, spacing, context);
  const std::size_t n = scan.position.size();
  const KdTree tree(scan.position, context);
  std::vector<std::vector<Neighbor>> near(n);
  std::vector<Histogram> bends(n);
  parallel::for_chunks(
      context, n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          near[i] = neighborhood(tree, scan.position[i], kRadius * spacing);
          bends[i] = bending(scan, i, near[i]);
        }
      },
      kChunk);

  DescribedPoints points;
  points.spacing = spacing;
  points.descriptor.assign(n * DescribedPoints::kBins, 0.0F);
  parallel::for_chunks(
      context, n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          describe(bends, i, near[i], &points.descriptor[i * DescribedPoints::kBins]);
        }
      },
      kChunk);
  points.keypoints = thinned_keypoints(scan, keypoints, near);
  points.position = std::move(scan.position);
  points.normal = std::move(scan.normal);
  return points;
}

}  // namespace shapelight
