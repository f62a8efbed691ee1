#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"
#include "simplify/edge_uses.hpp"

namespace shapelight {

/// Faces that lie folded on all their neighbours and look against the input around them, ascending. A sharp tip does
/// one of the two at most; a face that collapses, flips and moves have turned over little by little does both.
[[nodiscard]] std::vector<Index> turned_faces(const TriangleMesh& reference, const TriangleMesh& mesh,
                                              const EdgeUses& edges, const RunContext& context);

/// Flips edges of turned faces so that both new faces look where those around them do; the vertices stay. Edges between
/// two vertices of `features` stay. Returns how many faces are turned still. Cost: O(n) and little more.
std::size_t unfold_faces(const TriangleMesh& reference, SimplifiedMesh& result, const FeatureEdges& features,
                         const RunContext& context);

}  // namespace shapelight
