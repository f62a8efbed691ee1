#pragma once

#include <cstdint>

#include "shapelight/core/options.hpp"
#include "shapelight/synthetic/virtual_scan.hpp"

namespace shapelight {

/// Share of the source's points that lie within two point spacings of a target point: how much of the source's surface
/// the target shows. 0 when either has no point. Cost: O(n log n).
[[nodiscard]] double scan_overlap(const Geometry& source, const Geometry& target, const RigidTransform& T_target_source,
                                  const RunContext& context = {});

/// Which pair of scans to make; see VirtualScanOptions for the rest.
struct ScanPairOptions {
  double overlap = 0.8;        ///< [1] share of the source's points that the target shows as well
  double azimuth = 0.0;        ///< [rad] of the target's camera
  double elevation = 0.3;      ///< [rad] of both cameras
  double field_of_view = 0.5;  ///< [rad]
  VirtualScanOptions scan;     ///< of both scans; their noise and frames differ

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"overlap", "1", "Share of the source's points that the target shows as well.", 0.01, 0.99},
          o.overlap);
    visit(OptionInfo{"azimuth", "rad", "Azimuth of the target's camera.", -1e6, 1e6}, o.azimuth);
    visit(OptionInfo{"elevation", "rad", "Elevation of both cameras.", -1.57, 1.57}, o.elevation);
    visit(OptionInfo{"field-of-view", "rad", "Across the image.", 0.01, 3}, o.field_of_view);
    VirtualScanOptions::describe(o.scan, visit);
  }
};

struct ScanPair {
  VirtualScan source, target;
  RigidTransform T_target_source = RigidTransform::Identity();  ///< exact
  double overlap = 0.0;                                         ///< [1] of the two scans without noise and drop-outs
  double azimuth_between = 0.0;                                 ///< [rad] of the two cameras
};

/// Two scans of a surface whose overlap is `options.overlap` to within 0.01: both cameras stand at the same elevation,
/// and bisection finds how far apart they must be. `sphere` is about the surface.
/// Throws InvalidInput, TargetUnreachable (nothing like that overlap is met, as with an object that looks the same all
/// round), Cancelled. Cost: at most 20 scans and overlaps. Same result for any RunContext.
[[nodiscard]] ScanPair scan_pair(const TriangleTree& surface, const BoundingSphere& sphere,
                                 const ScanPairOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
