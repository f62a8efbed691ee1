#pragma once

#include <span>
#include <vector>

#include "simplify/measured_mesh.hpp"

namespace shapelight::simplification {

/// Which input vertices the live vertices stand on, for moves that keep them on input vertices.
struct InputPlaces {
  std::span<const Vec3> position;              ///< per input vertex
  std::span<const std::array<Index, 2>> line;  ///< per input vertex: neighbours along its line
  std::span<const std::uint8_t> locked;        ///< per input vertex
  std::vector<std::uint8_t> taken;             ///< per input vertex: a live vertex stands on it
};

/// One sweep: every live vertex moves to the free input vertex of its star that lowers the energy most, if any does.
/// Vertices on lines move along their line. Returns the number of moves.
std::size_t move_vertices(MeasuredMesh& measured, InputPlaces& places, double normal_weight, const RunContext& context);

}  // namespace shapelight::simplification
