#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/triangle_mesh.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight {

/// Parameters of measure_surface_distance().
struct SurfaceDistanceOptions {
  std::size_t samples = 0;  ///< [points] per surface; 0: ten per vertex of the larger mesh, at least 100,000
  std::uint64_t seed = 0;   ///< the only source of randomness

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"samples", "points", "Samples per surface; 0: ten per vertex of the larger, at least 100000.", 0,
                     1e9},
          o.samples);
    visit(OptionInfo{"seed", "", "Another seed gives other samples.", 0, 1e18}, o.seed);
  }
};

/// Distances from the points of one surface to another surface. [input length unit]
struct DistanceSummary {
  double mean = 0.0;  ///< over the area
  double rms = 0.0;   ///< over the area: eq. 15
  double max = 0.0;   ///< over the samples and all vertices: the one-sided Hausdorff distance from below

  [[nodiscard]] DistanceSummary scaled(double factor) const { return {mean * factor, rms * factor, max * factor}; }
};

/// Angles between the face normals at a point and at its closest point. [rad]
struct NormalDeviation {
  double rms = 0.0;
  double p95 = 0.0;  ///< 95th percentile
};

struct SurfaceDistance {
  DistanceSummary forward;           ///< from the reference to the test mesh
  DistanceSummary backward;          ///< from the test mesh to the reference
  DistanceSummary symmetric;         ///< mean of the means, root of the mean square, larger maximum
  double vertex_rms = 0.0;           ///< root mean square over the vertices of the reference, to the test mesh
  double diagonal = 0.0;             ///< of the reference's bounding box; scaled(1 / diagonal) is relative
  NormalDeviation normal_deviation;  ///< of both directions together
  std::size_t samples = 0;           ///< [points] taken per surface
};

/// Measures how far two surfaces are apart, as Metro does (Cignoni, Rocchini and Scopigno 1998), with exact closest
/// points: area-uniform stratified samples of both surfaces for the means, and all vertices too for the maxima.
/// Vertices without a triangle are no part of a surface. Samples whose own or closest face has no area have no normal
/// deviation.
/// Throws: InvalidInput (no triangle or no area, index out of range, non-finite corner: says in which mesh), Cancelled.
/// Cost:   O((s + n) log n), about a microsecond per sample; 4 bytes per sample. Same result for any RunContext.
[[nodiscard]] SurfaceDistance measure_surface_distance(const MeshView& reference, const MeshView& test,
                                                       const SurfaceDistanceOptions& options = {},
                                                       const RunContext& context = {});

/// Distance from every vertex to the surface, as Metro writes it per vertex; NaN at a vertex that is not finite.
/// Cost: O(n log n).
[[nodiscard]] std::vector<double> vertex_distances(const MeshView& mesh, const TriangleTree& surface,
                                                   const RunContext& context = {});

}  // namespace shapelight
