#pragma once

#include "pipeline/simplify_surface.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"

namespace shapelight::pipeline {

/// Edges where the texture coordinates of two faces disagree at an end: they must stay lines.
[[nodiscard]] FeatureEdges texture_seams(const Geometry& geometry, const Surface& surface, const RunContext& context);

/// Gives `output` (whose triangles are those of `simplified`) the attributes of `input`.
///
/// - Vertices, Placement::Input: those of the source vertex. Optimal: interpolated at the closest point of the surface:
///   numbers linearly, integers rounded, normals made unit, labels (by name, and 64-bit integers) from the nearest
///   corner.
/// - Triangles: those of the input triangle closest to the centroid.
/// - Texture coordinates: of the input face closest to the corner among those that are reached from below the output
///   face's centroid without crossing a seam, so that both sides of a seam keep their own.
void transfer_attributes(const Geometry& input, const Surface& surface, const SimplifiedMesh& simplified,
                         Placement placement, Geometry& output, const RunContext& context);

}  // namespace shapelight::pipeline
