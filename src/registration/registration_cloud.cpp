#include "shapelight/registration/registration_cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/data/geometry.hpp"

namespace shapelight {
namespace {

// Median distance to the nearest other place; duplicates of a point do not count as its neighbours.
double median_spacing(const RegistrationCloud& cloud, const RunContext& context) {
  const std::vector<Index> nearest = cloud.tree.all_nearest(1, context);
  context.check();
  std::vector<double> distance;
  distance.reserve(nearest.size());
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i] == kNoIndex) continue;
    const double d = (cloud.position[i] - cloud.position[nearest[i]]).norm();
    if (d > 0.0) distance.push_back(d);
  }
  if (distance.empty()) return 0.0;
  const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
  std::nth_element(distance.begin(), middle, distance.end());
  return *middle;
}

// Before a tree is built over them.
std::vector<Vec3> checked(std::vector<Vec3> positions) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!positions[i].allFinite()) throw InvalidInput(fmt::format("registration: point {} is not finite", i));
  }
  return positions;
}

}  // namespace

RegistrationCloud::RegistrationCloud(std::vector<Vec3> positions, std::vector<Vec3> normals, const RunContext& context)
    : position(checked(std::move(positions))), normal(std::move(normals)), tree(position, context) {
  if (!normal.empty() && normal.size() != position.size()) {
    throw InvalidInput(
        fmt::format("registration: {} normals for {} points, expected one each or none", normal.size(), size()));
  }
  spacing = median_spacing(*this, context);
  diagonal = bounding_box(position).diagonal();
}

}  // namespace shapelight
