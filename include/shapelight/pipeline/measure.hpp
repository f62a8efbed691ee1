#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/metrics/surface_distance.hpp"

namespace shapelight {

/// Exactly one member of the first two is set.
struct MeasureResult {
  std::optional<SurfaceDistance> surfaces;  ///< both inputs have a surface
  std::optional<SamplingQuality> points;    ///< one is a cloud: how well the test's points cover the reference's
  double diagonal = 0.0;                    ///< [input length unit] of the reference's bounding box
  std::vector<std::string> warnings;
};

/// How far two surfaces are apart, or how well the points of `test` stand for those of `reference`. Range images are
/// cut into triangles; triangles at points that were never measured are no surface. Features, where points are
/// measured, are the tenth of the reference with the largest surface variation over 30 neighbours.
/// Throws InvalidInput, Cancelled, as measure_surface_distance() and measure_sampling().
[[nodiscard]] MeasureResult measure(const GeometryView& reference, const GeometryView& test,
                                    const SurfaceDistanceOptions& options = {}, const RunContext& context = {});

/// Distance from every point of `test` to the surface of `reference`, [input length unit]; NaN at points that are not
/// finite. Throws InvalidInput when the reference has no surface, Cancelled. Cost: O(n log n).
[[nodiscard]] std::vector<double> distances_to_surface(const GeometryView& reference, const GeometryView& test,
                                                       const RunContext& context = {});

}  // namespace shapelight
