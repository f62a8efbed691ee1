#pragma once

#include <optional>
#include <span>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Parameters of the graph builders.
struct GraphOptions {
  int neighbors = 12;         ///< [points] k of the symmetric k-nearest-neighbour graph of a raw cloud
  double depth_jump = 6.0;    ///< [median pixel spacings] longer edges of a range image are cut
  bool flag_outliers = true;  ///< raw clouds: flag strays

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"neighbors", "points", "Neighbours per point in the graph of a raw cloud.", 4, 64}, o.neighbors);
    visit(OptionInfo{"depth-jump", "median pixel spacings", "Longer edges between pixels of a range image are cut.",
                     1.5, 1e6},
          o.depth_jump);
    visit(OptionInfo{"flag-outliers", "", "Flag strays of a raw cloud, so that they are chosen last.", 0, 1},
          o.flag_outliers);
  }
};

struct BuiltGraph {
  SurfaceGraph graph;
  GraphDiagnostics diagnostics;
};

/// Edges and areas of a triangle mesh. Duplicate positions become one vertex (seams close); triangles with a repeated
/// vertex or no area are left out and counted; edges of one triangle make boundary vertices; edges of more than two are
/// counted and kept. Normals are area-weighted; a closed component that winds inwards gets its normals turned outwards.
/// Non-finite positions and the triangles at them are left out. Vertices without a triangle stay, isolated; those
/// farther than three mean edge lengths from the surface are flagged. Throws InvalidInput when a triangle names a
/// vertex that is not there. Cost: O(n), about 150 bytes per vertex.
[[nodiscard]] BuiltGraph graph_from_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                         const RunContext& context = {});

/// Cuts the pixel grid into triangles and leaves out those that bridge a depth jump: an edge longer than `depth_jump`
/// times the local spacing of the pixels (see range_image_triangles). Normals look towards the viewpoint; without one,
/// away from the centre of the points.
[[nodiscard]] BuiltGraph graph_from_range_image(std::span<const Vec3> positions, const RangeGrid& grid,
                                                const std::optional<Vec3>& viewpoint, const GraphOptions& options = {},
                                                const RunContext& context = {});

/// Symmetric k-nearest-neighbour graph of a raw cloud (i ~ j when either is among the other's k nearest). Area is
/// pi r_k^2 / k. Normals by principal components of the k nearest, oriented along the minimum spanning tree of
/// 1 - |n_i . n_j| (Hoppe et al. 1992) and, per component, towards the viewpoint or, without one, outwards.
/// Boundary: the neighbours' centroid lies off to one side. Strays: points with r_k above 4 times the median of the
/// neighbours', or 6 times that of an evenly sampled cloud, that no dense point counts among its nearest and that stand
/// off their neighbours' tangent planes; and small groups apart from everything.
/// Cost: O(n log n), dominated by the neighbour search.
[[nodiscard]] BuiltGraph graph_from_points(std::span<const Vec3> positions, const std::optional<Vec3>& viewpoint,
                                           const GraphOptions& options = {}, const RunContext& context = {});

/// Vertices without edges, normals or areas, and none flagged: for methods that look at positions only. Cost: O(n).
[[nodiscard]] BuiltGraph graph_of_places(std::span<const Vec3> positions, const RunContext& context = {});

/// The builder that fits geometry.kind().
[[nodiscard]] BuiltGraph build_graph(const GeometryView& geometry, const GraphOptions& options = {},
                                     const RunContext& context = {});

/// The triangles of a range image: two per square of four pixels, split along the shorter diagonal, one where a pixel
/// is empty; none across depth jumps. An edge is a jump when it is longer than `depth_jump` times the median spacing of
/// neighbouring pixels; with a viewpoint, spacing is measured relative to the distance from it, as pixels fan out.
/// Indices are those of the points.
[[nodiscard]] std::vector<Triangle> range_image_triangles(std::span<const Vec3> positions, const RangeGrid& grid,
                                                          const std::optional<Vec3>& viewpoint, double depth_jump,
                                                          const RunContext& context = {});

}  // namespace shapelight
