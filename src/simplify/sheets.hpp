#pragma once

#include "simplify/manifold_mesh.hpp"

namespace shapelight::simplification {

/// Any triangles cut into sheets, each of them an oriented manifold with border.
struct Sheets {
  std::vector<Triangle> triangles;   ///< indices into source
  std::vector<Index> source;         ///< per vertex, ascending: input vertex; copies of one are neighbours
  std::vector<std::uint8_t> locked;  ///< per vertex: at a junction
};

/// The general path of make_manifold(). Pre: indices in range, no face names a vertex twice.
/// Counts duplicate and reoriented faces in `oddities`.
[[nodiscard]] Sheets cut_into_sheets(std::span<const Vec3> positions, std::vector<Triangle> triangles,
                                     MeshOddities& oddities, const RunContext& context);

}  // namespace shapelight::simplification
