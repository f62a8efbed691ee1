#include "registration/thin_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/poll.hpp"
#include "shapelight/data/geometry.hpp"

namespace shapelight {
namespace {

constexpr int kBitsPerAxis = 21;
constexpr double kAgreement = 0.3;  // length of the mean normal of a cell, below which it says nothing

/// Numbers the cubic cells of a box. The middle of the box is the middle of a cell, so that a flat sheet across it does
/// not lie on the border of its cells.
class CellNumbers {
 public:
  CellNumbers(std::span<const Vec3> points, double cell) : per_length_(1.0 / cell) {
    const BoundingBox box = bounding_box(points);
    center_ = box.center();
    shift_ = (0.5 * per_length_ * (box.max - box.min)).array().floor() + 1.5;
  }
  [[nodiscard]] std::uint64_t of(const Vec3& p) const {
    const Vec3 q = (p - center_) * per_length_ + shift_;
    const auto axis = [&](int a) { return static_cast<std::uint64_t>(q[a]); };
    return (((axis(0) << kBitsPerAxis) | axis(1)) << kBitsPerAxis) | axis(2);
  }

 private:
  double per_length_;
  Vec3 center_;
  Vec3 shift_;
};

}  // namespace

ThinnedScan thin_scan(const RegistrationCloud& cloud, double cell, const RunContext& context) {
  const CellNumbers number(cloud.position, cell);
  std::vector<std::pair<std::uint64_t, Index>> order;
  order.reserve(cloud.size());
  for (Index i = 0; i < cloud.size(); ++i) {
    poll(context, i);
    if (cloud.normal[i].squaredNorm() > 0.0) order.emplace_back(number.of(cloud.position[i]), i);
  }
  std::size_t compared = 0;
  std::sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
    poll(context, compared++);
    return a < b;
  });

  ThinnedScan scan;
  scan.index_of_point.assign(cloud.size(), kNoIndex);
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    poll(context, scan.position.size());
    Vec3 offset = Vec3::Zero();
    Vec3 normal = Vec3::Zero();
    const Vec3& first = cloud.position[order[begin].second];
    for (end = begin; end < order.size() && order[end].first == order[begin].first; ++end) {
      offset += cloud.position[order[end].second] - first;
      normal += cloud.normal[order[end].second];
    }
    // Both sides of a thin sheet in one cell: no direction to speak of.
    if (normal.norm() < kAgreement * static_cast<double>(end - begin)) continue;
    for (std::size_t i = begin; i < end; ++i) {
      scan.index_of_point[order[i].second] = static_cast<Index>(scan.position.size());
    }
    scan.position.push_back(first + offset / static_cast<double>(end - begin));
    scan.normal.push_back(normal.normalized());
  }
  return scan;
}

std::size_t count_cells(std::span<const Vec3> points, double cell) {
  const CellNumbers number(points, cell);
  std::vector<std::uint64_t> cells(points.size());
  std::transform(points.begin(), points.end(), cells.begin(), [&](const Vec3& p) { return number.of(p); });
  std::sort(cells.begin(), cells.end());
  return static_cast<std::size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

}  // namespace shapelight
