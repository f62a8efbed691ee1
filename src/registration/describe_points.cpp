#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"
#include "registration/thin_scan.hpp"
#include "registration/tune.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/registration/coarse_alignment.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kBinsPerAngle = DescribedPoints::kBins / 3;
constexpr std::size_t kChunk = 256;
using Histogram = std::array<float, DescribedPoints::kBins>;

/// Adds to the two bins next to a value in [0, 1]: a small change of the value then is a small change of the histogram.
void add(float* bins, double value) {
  const double place = value * static_cast<double>(kBinsPerAngle) - 0.5;
  const double floor = std::floor(place);
  const auto low = static_cast<long>(floor);
  const auto part = static_cast<float>(place - floor);
  const long last = kBinsPerAngle - 1;
  bins[std::clamp(low, 0L, last)] += 1.0F - part;
  bins[std::clamp(low + 1, 0L, last)] += part;
}

/// How the surface bends around point i: the angles of its neighbours' normals in the frame spanned by its own normal
/// and the direction to the neighbour (Rusu et al. 2009, eq. 1).
Histogram simple_histogram(const ThinnedScan& scan, std::size_t i, std::span<const Neighbor> near) {
  Histogram bins{};
  const Vec3& u = scan.normal[i];
  for (const Neighbor& neighbor : near) {
    const Vec3 direction = (scan.position[neighbor.index] - scan.position[i]) / std::sqrt(neighbor.distance_sq);
    const Vec3& n = scan.normal[neighbor.index];
    Vec3 v = direction.cross(u);
    const double length = v.norm();
    if (length < 1e-6) continue;  // straight above: no frame
    v /= length;
    const Vec3 w = u.cross(v);
    add(bins.data(), 0.5 * (v.dot(n) + 1.0));
    add(bins.data() + kBinsPerAngle, 0.5 * (u.dot(direction) + 1.0));
    add(bins.data() + 2 * kBinsPerAngle, 0.5 * (std::atan2(w.dot(n), u.dot(n)) / std::numbers::pi + 1.0));
  }
  for (float& value : bins) value /= static_cast<float>(std::max<std::size_t>(1, near.size()));
  return bins;
}

}  // namespace

double coarse_spacing(const RegistrationCloud& cloud) {
  if (cloud.size() < 3 || cloud.spacing == 0.0) return 0.0;
  std::vector<Vec3> points;
  const std::size_t stride = cloud.size() / 40000 + 1;
  for (std::size_t i = 0; i < cloud.size(); i += stride) points.push_back(cloud.position[i]);
  double cell = cloud.diagonal / 60.0;
  for (int pass = 0; pass < 4; ++pass) {
    cell *= std::sqrt(static_cast<double>(count_cells(points, cell)) / tune::N_THIN);
  }
  return std::max(cell, 2.0 * cloud.spacing);
}

DescribedPoints describe_points(const RegistrationCloud& cloud, std::span<const Index> keypoints, double spacing,
                                const RunContext& context) {
  if (cloud.normal.empty() && cloud.size() > 0) throw InvalidInput("describe_points: the cloud has no normals");
  if (!(spacing > 0.0)) throw InvalidInput("describe_points: spacing must be positive");
  ThinnedScan scan = thin_scan(cloud, spacing);
  const std::size_t n = scan.position.size();
  DescribedPoints out;
  out.spacing = spacing;
  std::vector<std::uint8_t> taken(n, 0);
  for (const Index p : keypoints) {
    const Index cell = scan.point_cell[p];
    if (cell == kNoIndex || taken[cell]) continue;
    taken[cell] = 1;
    out.keypoints.push_back(cell);
    if (out.keypoints.size() >= tune::KEYS) break;
  }

  const KdTree tree(scan.position);
  std::vector<std::vector<Neighbor>> near(n);
  std::vector<Histogram> simple(n);
  parallel::for_chunks(
      context, n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          tree.within(scan.position[i], tune::RADIUS * spacing, near[i]);
          std::erase_if(near[i], [](const Neighbor& x) { return x.distance_sq == 0.0; });
          simple[i] = simple_histogram(scan, i, near[i]);
        }
      },
      kChunk);
  out.descriptor.resize(n * DescribedPoints::kBins);
  parallel::for_chunks(
      context, n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          Histogram sum{};
          float total = 0;
          for (const Neighbor& neighbor : near[i]) {
            const double d = std::sqrt(neighbor.distance_sq) / spacing;
            const auto weight = static_cast<float>(tune::WPOW == 2 ? 1 / (d * d) : tune::WPOW == 1 ? 1 / d : tune::WPOW == 0 ? 1 : 1 - d * d / (tune::RADIUS * tune::RADIUS));
            total += weight;
            for (std::size_t b = 0; b < sum.size(); ++b) sum[b] += weight * simple[neighbor.index][b];
          }
          if (total > 0)
            for (std::size_t b = 0; b < sum.size(); ++b) sum[b] = simple[i][b] + sum[b] / total;
          if (tune::HELL > 0) for (float& x : sum) x = std::sqrt(x);
          std::copy(sum.begin(), sum.end(), out.descriptor.begin() + i * DescribedPoints::kBins);
        }
      },
      kChunk);
  out.position = std::move(scan.position);
  out.normal = std::move(scan.normal);
  return out;
}

}  // namespace shapelight
