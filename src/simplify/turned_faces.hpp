#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"
#include "simplify/edge_uses.hpp"

namespace shapelight {

/// Faces that lie folded on all their neighbours and look against the input around them, ascending. A sharp tip does
/// one of the two at most; a face that collapses, flips and moves have turned over little by little does both. Where
/// more than two faces meet at an edge, several sheets of the input are near and none can say which way is out: faces
/// there are passed over.
[[nodiscard]] std::vector<Index> turned_faces(const TriangleMesh& reference, const TriangleMesh& mesh,
                                              const EdgeUses& edges, const RunContext& context);

/// Repairs turned faces: flips one of their edges so that both new faces look where those around them do or, where no
/// flip does, moves a corner towards the middle of its neighbours (Placement::Input: to an input vertex near there).
/// Vertices of `features` stay, and edges between two of them. Returns how many faces are turned still.
/// Cost: O(n), and as much again per corner moved.
std::size_t unfold_faces(const TriangleMesh& reference, SimplifiedMesh& result, Placement placement,
                         const FeatureEdges& features, const RunContext& context);

}  // namespace shapelight
