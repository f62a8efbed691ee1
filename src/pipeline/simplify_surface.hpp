#pragma once

#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/data/triangle_mesh.hpp"
#include "shapelight/graph/build_graph.hpp"

namespace shapelight::pipeline {

/// What of a geometry is simplified: its triangles, in coordinates relative to the centre of its box.
struct Surface {
  TriangleMesh mesh;                  ///< one vertex per point of the geometry
  std::vector<Index> triangle_of;     ///< per triangle: the geometry's; empty when they are the same
  Vec3 origin = Vec3::Zero();         ///< input frame
  std::size_t skipped_triangles = 0;  ///< left out: at points that are not finite
};

/// The triangles of a mesh, or those that a range image's grid is cut into: towards its viewpoint or, without one,
/// mostly outwards. Throws InvalidInput for an index out of range.
[[nodiscard]] Surface make_surface(const GeometryView& geometry, const GraphOptions& options,
                                   const RunContext& context);

}  // namespace shapelight::pipeline
