#include "shapelight/synthetic/scan_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"
#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight {
namespace {

constexpr double kOverlapTolerance = 0.01;
constexpr int kBisections = 18;

// Median distance to the nearest other place.
double point_spacing(const KdTree& tree, const std::vector<Vec3>& points, const RunContext& context) {
  const std::vector<Index> nearest = tree.all_nearest(1, context);
  std::vector<double> distance;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i] != kNoIndex) distance.push_back((points[i] - points[nearest[i]]).norm());
  }
  if (distance.empty()) return 0.0;
  const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
  std::nth_element(distance.begin(), middle, distance.end());
  return *middle;
}

// Points that registration could look at: a scan, a tree over it, and how dense it is.
struct Searchable {
  std::vector<Vec3> points;
  KdTree tree;
  double spacing;

  Searchable(const std::vector<Vec3>& positions, const RunContext& context)
      : points(finite(positions)), tree(points), spacing(point_spacing(tree, points, context)) {}

  static std::vector<Vec3> finite(const std::vector<Vec3>& positions) {
    std::vector<Vec3> kept;
    std::copy_if(positions.begin(), positions.end(), std::back_inserter(kept),
                 [](const Vec3& p) { return p.allFinite(); });
    return kept;
  }

  // Share of the source's points that lie within two spacings of one of these.
  [[nodiscard]] double shows(const std::vector<Vec3>& source, const RigidTransform& T_target_source,
                             const RunContext& context) const {
    const std::vector<Vec3> moved = finite(source);
    if (moved.empty() || points.empty()) return 0.0;
    const double reach_sq = 4.0 * spacing * spacing;
    const double close = parallel::sum(context, moved.size(), [&](std::size_t i) {
      return tree.nearest(T_target_source * moved[i]).distance_sq <= reach_sq ? 1.0 : 0.0;
    });
    return close / static_cast<double>(moved.size());
  }
};

RigidTransform between(const VirtualScan& source, const VirtualScan& target) {
  return target.T_mesh_scan.inverse() * source.T_mesh_scan;
}

VirtualScanOptions without_errors(VirtualScanOptions options) {
  options.noise = options.quantization = options.dropout = 0.0;
  options.random_pose = false;
  return options;
}

}  // namespace

double scan_overlap(const Geometry& source, const Geometry& target, const RigidTransform& T_target_source,
                    const RunContext& context) {
  return Searchable(target.positions, context).shows(source.positions, T_target_source, context);
}

ScanPair scan_pair(const TriangleTree& surface, const BoundingSphere& sphere, const ScanPairOptions& options,
                   const RunContext& context) {
  validate_options(options);
  const auto camera = [&](double azimuth_between) {
    return camera_on_sphere(sphere, options.azimuth + azimuth_between, options.elevation, options.field_of_view);
  };
  const RunContext quiet{context.max_threads, context.stop, {}};
  const VirtualScanOptions exact = without_errors(options.scan);
  const VirtualScan target = virtual_scan(surface, camera(0.0), exact, quiet);
  const Searchable searchable(target.geometry.positions, quiet);

  ScanPair pair;
  double near = 0.0, far = std::numbers::pi;  // more than enough overlap, less
  for (int i = 0; i <= kBisections; ++i) {
    context.report(static_cast<double>(i) / (kBisections + 2), "find the overlap");
    pair.azimuth_between = i == 0 ? far : 0.5 * (near + far);
    const VirtualScan source = virtual_scan(surface, camera(pair.azimuth_between), exact, quiet);
    pair.overlap = searchable.shows(source.geometry.positions, between(source, target), quiet);
    if (std::abs(pair.overlap - options.overlap) < kOverlapTolerance) break;
    if (i > 0) (pair.overlap > options.overlap ? near : far) = pair.azimuth_between;
    if (i == 0 && pair.overlap > options.overlap) break;
  }
  if (!(std::abs(pair.overlap - options.overlap) < kOverlapTolerance)) {
    throw TargetUnreachable(
        fmt::format("scan pair: overlap {}, expected {} within {}", pair.overlap, options.overlap, kOverlapTolerance),
        0);
  }
  VirtualScanOptions of_source = options.scan, of_target = options.scan;
  of_source.seed = random_bits(options.scan.seed, 0, 1);
  of_target.seed = random_bits(options.scan.seed, 0, 2);
  pair.source = virtual_scan(surface, camera(pair.azimuth_between), of_source, quiet);
  pair.target = virtual_scan(surface, camera(0.0), of_target, quiet);
  pair.T_target_source = between(pair.source, pair.target);
  context.report(1.0, "find the overlap");
  return pair;
}

}  // namespace shapelight
