#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight {

/// A pinhole camera. In its own frame it looks along z, x points to the right and y down, as in depth images.
struct VirtualCamera {
  RigidTransform T_mesh_camera = RigidTransform::Identity();  ///< its place in the frame of the mesh
  double field_of_view = 0.5;                                 ///< [rad] across the smaller side of the image
};

/// What the scanner does to the exact image.
struct VirtualScanOptions {
  int width = 320;             ///< [pixels]
  int height = 320;            ///< [pixels]
  double noise = 0.0;          ///< [input length unit] standard deviation of the measured range
  double quantization = 0.0;   ///< [input length unit] ranges are multiples of this; 0: exact
  double dropout = 0.0;        ///< [1] share of pixels that measure nothing, drawn at random
  double max_incidence = 1.4;  ///< [rad] between ray and surface normal; flatter surfaces are not seen
  bool random_pose = false;    ///< the scan's frame is a random one instead of the camera's
  std::uint64_t seed = 0;      ///< of noise, drop-outs and the random pose

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"width", "pixels", "Columns of the range image.", 1, 16384}, o.width);
    visit(OptionInfo{"height", "pixels", "Rows of the range image.", 1, 16384}, o.height);
    visit(OptionInfo{"noise", "input length unit", "Standard deviation of the measured range.", 0, 1e300}, o.noise);
    visit(OptionInfo{"quantization", "input length unit", "Ranges are multiples of this; 0: exact.", 0, 1e300},
          o.quantization);
    visit(OptionInfo{"dropout", "1", "Share of pixels that measure nothing.", 0, 1}, o.dropout);
    visit(OptionInfo{"max-incidence", "rad", "Flatter surfaces are not seen.", 0, 1.5707963267948966}, o.max_incidence);
    visit(OptionInfo{"random-pose", "", "Give the scan a random frame instead of the camera's.", 0, 0}, o.random_pose);
    visit(OptionInfo{"seed", "", "Seed of noise, drop-outs and the random pose.", 0, 0x1.0p64}, o.seed);
  }
};

/// A range image in a frame of its own, and where that frame is: the truth that registration should find.
struct VirtualScan {
  Geometry geometry;  ///< points, grid and viewpoint in the scan's frame; points in the order of their pixels
  RigidTransform T_mesh_scan = RigidTransform::Identity();
};

/// Scans a surface: one ray through the middle of every pixel, its first hit moved along the ray by Gaussian noise.
/// Both sides of a surface are seen. Without noise, points lie on the surface to the rounding of doubles.
/// Throws InvalidInput (options, a field of view outside (0, pi), no mesh in the tree), Cancelled.
/// Cost: one ray per pixel, about a microsecond each. Same result for any RunContext.
[[nodiscard]] VirtualScan virtual_scan(const TriangleTree& surface, const VirtualCamera& camera,
                                       const VirtualScanOptions& options = {}, const RunContext& context = {});

/// A sphere about an object, for cameras to look at.
struct BoundingSphere {
  Vec3 center = Vec3::Zero();
  double radius = 0.0;  ///< [input length unit]
};
/// About the middle of the bounding box, through the finite point farthest from it.
[[nodiscard]] BoundingSphere bounding_sphere(std::span<const Vec3> positions);

/// A camera that looks at the middle of the sphere from outside; y is up. The azimuth turns about y, from z towards x.
/// `distance` [sphere radii] from the middle; 0: so that the sphere just fits the image.
[[nodiscard]] VirtualCamera camera_on_sphere(const BoundingSphere& sphere, double azimuth, double elevation,
                                             double field_of_view = 0.5, double distance = 0.0);

/// `count` of these, evenly spaced in azimuth, the first at `azimuth`. [rad]
[[nodiscard]] std::vector<VirtualCamera> ring_of_cameras(const BoundingSphere& sphere, int count, double azimuth,
                                                         double elevation, double field_of_view = 0.5);

}  // namespace shapelight
