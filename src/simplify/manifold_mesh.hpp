#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"

namespace shapelight::simplification {

/// A mesh that collapses can work on: every edge has one face or two that run it in opposite directions, every vertex
/// has one fan of faces, every vertex is used. Vertices on non-manifold input are copies, one per fan.
struct ManifoldMesh {
  TriangleMesh mesh;
  std::vector<Index> source;         ///< per vertex: input vertex
  std::vector<std::uint8_t> locked;  ///< per vertex: may be neither removed nor moved (corner of lines, junction)
  /// Per vertex, or empty where sheets meet nowhere: the input vertex whose copies become one again in the end;
  /// kNoIndex for all others. Collapses make no edge and no face that another copy has.
  std::vector<Index> junction;
  /// Per vertex on a line (border or feature edges): its two neighbours along it; kNoIndex twice elsewhere. A vertex
  /// on a line collapses along it only. Line ends and junctions are locked.
  std::vector<std::array<Index, 2>> line;
};

/// Pairs the faces at every edge (by direction, then by the flattest angle), turns faces so that neighbours agree, and
/// gives every fan its own vertex. Copies at edges where pairing left a face over are locked.
/// Throws InvalidInput (index out of range; non-finite vertex in use).
[[nodiscard]] ManifoldMesh make_manifold(const TriangleMesh& mesh, const FeatureEdges& features,
                                         const RunContext& context, MeshOddities* oddities);

/// Back to plain triangles: locked copies of one input vertex become one vertex again.
[[nodiscard]] SimplifiedMesh merge_copies(ManifoldMesh&& mesh);

/// Vertices that merge_copies() would return.
[[nodiscard]] std::size_t num_merged_vertices(const ManifoldMesh& mesh);

}  // namespace shapelight::simplification
