#include "registration/sight.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace shapelight::registration {
namespace {

constexpr double kSpacingsPerCell = 2.5;  // so that a cell on a surface holds points
constexpr std::size_t kFinest = 512;      // [cells] along a side of a face

double median_range(const RegistrationCloud& cloud, const Vec3& viewpoint) {
  std::vector<double> range(cloud.size());
  std::transform(cloud.position.begin(), cloud.position.end(), range.begin(),
                 [&](const Vec3& p) { return (p - viewpoint).norm(); });
  const auto middle = range.begin() + static_cast<std::ptrdiff_t>(range.size() / 2);
  std::nth_element(range.begin(), middle, range.end());
  return *middle;
}

}  // namespace

Sight::Sight(const RegistrationCloud& cloud) : viewpoint_(*cloud.viewpoint) {
  const double range = median_range(cloud, viewpoint_);
  const double cell = range > 0.0 ? kSpacingsPerCell * cloud.spacing / range : 1.0;  // [1] on a face at distance 1
  resolution_ = std::clamp<std::size_t>(static_cast<std::size_t>(2.0 / std::max(cell, 1e-6)), 1, kFinest);
  nearest_.assign(6 * resolution_ * resolution_, 0.0f);
  for (const Vec3& p : cloud.position) {
    const Vec3 direction = p - viewpoint_;
    float& nearest = nearest_[cell_of(direction)];
    const float here = static_cast<float>(direction.norm());
    if (nearest == 0.0f || here < nearest) nearest = here;
  }
}

std::size_t Sight::cell_of(const Vec3& direction) const {
  Eigen::Index axis = 0;
  const double reach = direction.cwiseAbs().maxCoeff(&axis);
  const auto cell = [&](double coordinate) {  // of [-1, 1]
    const double place = reach > 0.0 ? 0.5 * (coordinate / reach + 1.0) : 0.5;
    return std::min(resolution_ - 1, static_cast<std::size_t>(place * static_cast<double>(resolution_)));
  };
  const std::size_t face = 2 * static_cast<std::size_t>(axis) + (direction[axis] < 0.0);
  return (face * resolution_ + cell(direction[(axis + 1) % 3])) * resolution_ + cell(direction[(axis + 2) % 3]);
}

Sight::Count Sight::count(std::span<const Vec3> points, const RigidTransform& T_cloud_points, double margin,
                          const RunContext& context) const {
  return parallel::reduce_chunks(
      context, points.size(), Count{},
      [&](std::size_t begin, std::size_t end) {
        Count found;
        for (std::size_t i = begin; i < end; ++i) {
          const Vec3 direction = T_cloud_points * points[i] - viewpoint_;
          const double nearest = nearest_[cell_of(direction)];
          if (nearest == 0.0) continue;
          ++found.in_sight;
          found.seen_through += direction.norm() + margin < nearest;
        }
        return found;
      },
      [](Count a, const Count& b) {
        return Count{a.seen_through + b.seen_through, a.in_sight + b.in_sight};
      });
}

}  // namespace shapelight::registration
