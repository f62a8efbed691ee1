#pragma once

#include "simplify/measured_mesh.hpp"

namespace shapelight::simplification {

/// Flips every edge whose flip lowers the measured energy, looking only where something has changed since the last
/// call. Returns the number of flips.
std::size_t flip_edges(MeasuredMesh& measured, const RunContext& context);

}  // namespace shapelight::simplification
