#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/types.hpp"
#include "shapelight/data/triangle_mesh.hpp"

namespace shapelight {

/// Where the vertices of a simplified mesh may lie.
enum class Placement : std::uint8_t {
  Input,   ///< on input vertices only
  Optimal  ///< anywhere: wherever the error is least
};

[[nodiscard]] constexpr auto enum_names(Placement) {
  return std::array<std::pair<Placement, std::string_view>, 2>{
      {{Placement::Input, "input"}, {Placement::Optimal, "optimal"}}};
}

/// How far to simplify: exactly one member is not 0.
struct SimplifyTarget {
  std::size_t vertices = 0;  ///< [vertices] reached exactly
  std::size_t faces = 0;     ///< [faces] reached, or missed by one: a collapse takes two faces
};

/// Edges that must survive as lines, as pairs of vertex indices in any order: texture seams, say.
using FeatureEdges = std::vector<std::array<Index, 2>>;

struct SimplifiedMesh {
  TriangleMesh mesh;                 ///< every vertex is used by a triangle
  std::vector<Index> source_vertex;  ///< per vertex: the input vertex it is (Placement::Input) or descends from
};

/// Odd but usable things met in the input.
struct MeshOddities {
  std::size_t degenerate_faces = 0;       ///< faces that name a vertex twice: left out
  std::size_t duplicate_faces = 0;        ///< further faces over the same three vertices: left out
  std::size_t reoriented_faces = 0;       ///< faces turned over to agree with their neighbours
  std::size_t split_vertices = 0;         ///< extra copies where sheets only touched: each sheet got its own vertex
  std::size_t locked_vertices = 0;        ///< where sheets meet and cannot be told apart: kept as they are
  std::size_t unused_vertices = 0;        ///< in no face: left out
};

}  // namespace shapelight
