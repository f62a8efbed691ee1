#include "shapelight/synthetic/virtual_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.hpp"
#include "core/random.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

constexpr std::uint64_t kDropoutStream = 0, kNoiseStream = 1, kPoseStream = 3;  // noise takes two
constexpr std::size_t kRaysPerChunk = 1024;

double gaussian(std::uint64_t seed, std::uint64_t id) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random01(seed, kNoiseStream, id)));
  return radius * std::cos(2.0 * std::numbers::pi * random01(seed, kNoiseStream + 1, id));
}

// Any rotation is as likely as any other (Shoemake 1992); moved by up to `reach` along each axis.
RigidTransform random_transform(std::uint64_t seed, double reach) {
  const auto draw = [&](std::uint64_t i) { return random01(seed, kPoseStream, i); };
  const double u = draw(0), a = 2.0 * std::numbers::pi * draw(1), b = 2.0 * std::numbers::pi * draw(2);
  const Eigen::Quaterniond rotation(std::sqrt(1.0 - u) * std::sin(a), std::sqrt(1.0 - u) * std::cos(a),
                                    std::sqrt(u) * std::sin(b), std::sqrt(u) * std::cos(b));
  RigidTransform transform(rotation.normalized());
  transform.translation() = reach * (2.0 * Vec3(draw(3), draw(4), draw(5)) - Vec3::Ones());
  return transform;
}

class Scanner {
 public:
  Scanner(const TriangleTree& surface, const VirtualCamera& camera, const VirtualScanOptions& options)
      : surface_(surface), camera_(camera), options_(options) {
    const double focal_length = 0.5 * std::min(options.width, options.height) / std::tan(0.5 * camera.field_of_view);
    pixel_size_ = 1.0 / focal_length;
    least_cosine_ = std::cos(options.max_incidence);
  }

  // In the camera's frame; not finite where nothing is measured.
  [[nodiscard]] Vec3 measure(std::size_t pixel) const {
    static const Vec3 kNothing = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    if (random01(options_.seed, kDropoutStream, pixel) < options_.dropout) return kNothing;
    const auto width = static_cast<std::size_t>(options_.width);
    const double column = static_cast<double>(pixel % width) - 0.5 * (options_.width - 1);
    const double row = static_cast<double>(pixel / width) - 0.5 * (options_.height - 1);
    const Vec3 ray = Vec3(column * pixel_size_, row * pixel_size_, 1.0).normalized();
    const Vec3 direction = camera_.T_mesh_camera.linear() * ray;
    const TriangleTree::RayHit hit = surface_.first_hit(camera_.T_mesh_camera.translation(), direction);
    if (!hit || std::abs(hit.normal.dot(direction)) < least_cosine_) return kNothing;
    double range = hit.distance;
    if (options_.noise > 0.0) range += options_.noise * gaussian(options_.seed, pixel);
    if (options_.quantization > 0.0) range = std::round(range / options_.quantization) * options_.quantization;
    return range > 0.0 ? Vec3(range * ray) : kNothing;
  }

 private:
  const TriangleTree& surface_;
  const VirtualCamera& camera_;
  const VirtualScanOptions& options_;
  double pixel_size_ = 0.0;  // at unit depth
  double least_cosine_ = 0.0;
};

void check_field_of_view(double angle) {
  if (!(angle > 0.0 && angle < std::numbers::pi)) {
    throw InvalidInput(fmt::format("scan: field of view {} rad, expected more than 0 and less than pi", angle));
  }
}

}  // namespace

VirtualScan virtual_scan(const TriangleTree& surface, const VirtualCamera& camera, const VirtualScanOptions& options,
                         const RunContext& context) {
  validate_options(options);
  check_field_of_view(camera.field_of_view);
  if (surface.size() == 0) throw InvalidInput("scan: the surface is empty, expected triangles");
  context.report(0.0, "cast rays");
  const Scanner scanner(surface, camera, options);
  const std::size_t pixels = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  std::vector<Vec3> measured(pixels);
  parallel::for_chunks(
      context, pixels,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) measured[i] = scanner.measure(i);
      },
      kRaysPerChunk);

  RigidTransform T_scan_camera = RigidTransform::Identity();
  if (options.random_pose) {
    const BoundingBox seen = bounding_box(measured);
    T_scan_camera = random_transform(options.seed, seen.diagonal());
    T_scan_camera.translation() -= T_scan_camera.linear() * seen.center();
  }
  VirtualScan scan;
  scan.T_mesh_scan = camera.T_mesh_camera * T_scan_camera.inverse();
  scan.geometry.viewpoint = T_scan_camera.translation();
  RangeGrid grid{static_cast<std::uint32_t>(options.width), static_cast<std::uint32_t>(options.height), {}};
  grid.pixel.assign(pixels, kNoIndex);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!measured[i].allFinite()) continue;
    grid.pixel[i] = static_cast<Index>(scan.geometry.size());
    scan.geometry.positions.push_back(T_scan_camera * measured[i]);
  }
  scan.geometry.grid = std::move(grid);
  context.report(1.0, "cast rays");
  return scan;
}

BoundingSphere bounding_sphere(std::span<const Vec3> positions) {
  BoundingSphere sphere;
  sphere.center = bounding_box(positions).center();
  for (const Vec3& p : positions) {
    if (p.allFinite()) sphere.radius = std::max(sphere.radius, (p - sphere.center).norm());
  }
  return sphere;
}

VirtualCamera camera_on_sphere(const BoundingSphere& sphere, double azimuth, double elevation, double field_of_view,
                               double distance) {
  check_field_of_view(field_of_view);
  if (!std::isfinite(azimuth) || !std::isfinite(elevation) || !(distance >= 0.0) || !std::isfinite(distance)) {
    throw InvalidInput(fmt::format("scan: camera at azimuth {}, elevation {}, distance {}, expected finite numbers",
                                   azimuth, elevation, distance));
  }
  const double radii = distance > 0.0 ? distance : 1.0 / std::sin(0.5 * field_of_view);
  const Vec3 outward(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                     std::cos(elevation) * std::cos(azimuth));
  // From the azimuth alone, so that it is defined at the poles as well.
  const Vec3 right(std::cos(azimuth), 0.0, -std::sin(azimuth));
  VirtualCamera camera;
  camera.field_of_view = field_of_view;
  camera.T_mesh_camera.linear().col(0) = right;
  camera.T_mesh_camera.linear().col(1) = right.cross(outward);  // down
  camera.T_mesh_camera.linear().col(2) = -outward;
  camera.T_mesh_camera.translation() = sphere.center + radii * sphere.radius * outward;
  return camera;
}

std::vector<VirtualCamera> ring_of_cameras(const BoundingSphere& sphere, int count, double azimuth, double elevation,
                                           double field_of_view) {
  if (count < 1) throw InvalidInput(fmt::format("scan: {} cameras on a ring, expected 1 or more", count));
  std::vector<VirtualCamera> cameras;
  for (int i = 0; i < count; ++i) {
    cameras.push_back(camera_on_sphere(sphere, azimuth + 2.0 * std::numbers::pi * i / count, elevation, field_of_view));
  }
  return cameras;
}

}  // namespace shapelight
