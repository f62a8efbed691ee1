#pragma once

#include "shapelight/core/run_context.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"

namespace shapelight {

/// The mesh without its oddities, which are counted: what every simplification starts from and is checked against.
/// Throws InvalidInput (index out of range; non-finite vertex in use), Cancelled.
[[nodiscard]] SimplifiedMesh without_oddities(const TriangleMesh& mesh, MeshOddities& oddities,
                                              const RunContext& context = {});

/// Checks what is promised of a simplified mesh. `reference` is what without_oddities() made of the input.
///
/// - The count is that of `target`; of faces, within one. Indices are in range, positions finite, every vertex used.
/// - Placement::Input: every vertex is its source, bit for bit.
/// - No face repeats a vertex or another face. No edge has more than two faces unless it has in `reference`.
/// - The Euler characteristic is that of `reference`, and the borders are not more: no new hole, handle or part.
/// - No face is turned over: none that lies folded on all its neighbours and looks against the input around it.
///
/// Throws PostconditionFailed, naming the first broken promise and its place; Cancelled. Cost: O(n + m).
void check_result(const SimplifiedMesh& reference, const SimplifiedMesh& result, const SimplifyTarget& target,
                  Placement placement, const RunContext& context = {});

}  // namespace shapelight
