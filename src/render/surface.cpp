#include "render/surface.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight::drawing {
namespace {

Vec3f unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 && std::isfinite(length) ? Vec3f((v / length).cast<float>()) : Vec3f(Vec3f::Zero());
}

/// Normals that came with the item or its file; empty when there are none.
std::vector<Vec3f> given_normals(const RenderItem& item) {
  const Geometry& geometry = *item.geometry;
  std::vector<Vec3f> normals;
  if (!item.point_normals.empty()) {
    if (item.point_normals.size() != geometry.size()) {
      throw InvalidInput(fmt::format("render: {} normals for {} points, expected one each", item.point_normals.size(),
                                     geometry.size()));
    }
    normals.resize(geometry.size());
    std::transform(item.point_normals.begin(), item.point_normals.end(), normals.begin(), unit_or_zero);
    return normals;
  }
  const Column* x = geometry.attributes.find("nx");
  const Column* y = geometry.attributes.find("ny");
  const Column* z = geometry.attributes.find("nz");
  if (x == nullptr || y == nullptr || z == nullptr) return normals;
  normals.resize(geometry.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    normals[i] = unit_or_zero({x->as_double(i), y->as_double(i), z->as_double(i)});
  }
  return normals;
}

/// The median; 0 of nothing.
double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

constexpr std::size_t kPlaneNeighbors = 12;
constexpr std::size_t kSpacingNeighbor = 6;  // of a regular surface sample it lies 1.4 spacings away

/// Normals (of unknown side) and radii of points from their neighbours.
void estimate_discs(const Geometry& geometry, Surface& surface, bool need_normals, const RunContext& context) {
  std::vector<Index> finite;
  for (Index i = 0; i < geometry.size(); ++i) {
    if (geometry.positions[i].allFinite()) finite.push_back(i);
  }
  std::vector<Vec3> points(finite.size());
  std::transform(finite.begin(), finite.end(), points.begin(), [&](Index i) { return geometry.positions[i]; });
  const KdTree tree(points, context);
  if (need_normals) surface.normals.assign(geometry.size(), Vec3f::Zero());
  surface.radius.assign(geometry.size(), 0.0F);
  parallel::for_chunks(context, finite.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> found;
    for (std::size_t i = begin; i < end; ++i) {
      tree.nearest(points[i], kPlaneNeighbors + 1, found);
      const std::size_t rank = std::min(kSpacingNeighbor, found.size() - 1);
      surface.radius[finite[i]] = static_cast<float>(0.7 * std::sqrt(found[rank].distance_sq));
      if (!need_normals) continue;
      Vec3 mean = Vec3::Zero();
      for (const Neighbor& n : found) mean += points[n.index] - points[i];
      mean /= static_cast<double>(found.size());
      Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
      for (const Neighbor& n : found) {
        const Vec3 d = points[n.index] - points[i] - mean;
        spread += d * d.transpose();
      }
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
      solver.computeDirect(spread);
      // Points on a line, or all in one place, have no plane.
      if (solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[2]) {
        surface.normals[finite[i]] = unit_or_zero(solver.eigenvectors().col(0));
      }
    }
  });
  std::vector<double> radii;
  for (const Index i : finite) {
    if (surface.radius[i] > 0.0F) radii.push_back(surface.radius[i]);
  }
  const auto typical = static_cast<float>(median(radii));
  for (const Index i : finite) surface.radius[i] = std::clamp(surface.radius[i], 0.5F * typical, 3.0F * typical);
}

}  // namespace

std::vector<Triangle> triangulate_grid(const Geometry& geometry, const RunContext& context) {
  const RangeGrid& grid = *geometry.grid;
  const auto point = [&](std::uint32_t column, std::uint32_t row) -> Index {
    const Index i = grid.pixel[static_cast<std::size_t>(row) * grid.width + column];
    return i != kNoIndex && geometry.positions[i].allFinite() ? i : kNoIndex;
  };
  const auto reach = [&](Index i) {
    return geometry.viewpoint ? (geometry.positions[i] - *geometry.viewpoint).norm() : 1.0;
  };
  const auto length = [&](Index i, Index j) { return (geometry.positions[i] - geometry.positions[j]).norm(); };
  std::vector<double> steps;
  for (std::uint32_t row = 0; row < grid.height; ++row) {
    context.check();
    for (std::uint32_t column = 0; column + 1 < grid.width; ++column) {
      const Index i = point(column, row);
      const Index j = point(column + 1, row);
      if (i != kNoIndex && j != kNoIndex) steps.push_back(length(i, j) / reach(i));
    }
  }
  const double limit = 6.0 * median(steps);
  std::vector<Triangle> triangles;
  const auto add = [&](Index a, Index b, Index c) {
    if (a == kNoIndex || b == kNoIndex || c == kNoIndex) return;
    const double longest = std::max({length(a, b), length(b, c), length(c, a)});
    if (longest <= limit * reach(a)) triangles.push_back({a, b, c});
  };
  for (std::uint32_t row = 0; row + 1 < grid.height; ++row) {
    context.check();
    for (std::uint32_t column = 0; column + 1 < grid.width; ++column) {
      const Index a = point(column, row), b = point(column + 1, row);
      const Index c = point(column + 1, row + 1), d = point(column, row + 1);
      const bool only_bd = a == kNoIndex || c == kNoIndex;
      const bool both = !only_bd && b != kNoIndex && d != kNoIndex;
      if (only_bd || (both && length(b, d) < length(a, c))) {
        add(a, b, d);
        add(b, c, d);
      } else {
        add(a, b, c);
        add(a, c, d);
      }
    }
  }
  return triangles;
}

std::vector<Vec3f> triangle_normals(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                    const RunContext& context) {
  std::vector<Vec3> sums(positions.size(), Vec3::Zero());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    poll(context, i);
    const Triangle& t = triangles[i];
    const std::array<Vec3, 3> side = {positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[1]],
                                      positions[t[0]] - positions[t[2]]};
    const Vec3 normal = side[0].cross(side[1]);
    const double twice_area = normal.norm();
    if (!(twice_area > 0.0) || !std::isfinite(twice_area)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      sums[t[k]] += normal * (std::atan2(twice_area, -side[k].dot(side[(k + 2) % 3])) / twice_area);
    }
  }
  context.check();
  std::vector<Vec3f> normals(positions.size());
  std::transform(sums.begin(), sums.end(), normals.begin(), unit_or_zero);
  return normals;
}

Surface make_surface(const RenderItem& item, const RunContext& context) {
  const Geometry& geometry = *item.geometry;
  Surface surface;
  surface.triangles = geometry.triangles;
  if (geometry.triangles.empty() && geometry.grid) {
    surface.own_triangles = triangulate_grid(geometry, context);
    surface.triangles = surface.own_triangles;
  }
  surface.normals = given_normals(item);
  if (surface.triangles.empty()) {
    estimate_discs(geometry, surface, surface.normals.empty(), context);
    return surface;
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Index largest = *std::max_element(surface.triangles[t].begin(), surface.triangles[t].end());
    if (largest >= geometry.size()) {
      throw InvalidInput(fmt::format("render: triangle {} names vertex {} of {}", t, largest, geometry.size()));
    }
  }
  if (surface.normals.empty()) surface.normals = triangle_normals(geometry.positions, surface.triangles, context);
  return surface;
}

}  // namespace shapelight::drawing
