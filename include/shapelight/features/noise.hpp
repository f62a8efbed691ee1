#pragma once

#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Robust estimate of the measurement noise: standard deviation along the normal, [input length unit].
///
/// Every vertex is left standing beside the quadric that fits its 2-ring best; the residual of a least-squares fit has
/// the standard deviation sigma sqrt(1 - h), h being the vertex's own leverage, so dividing by that calibrates each
/// vertex exactly, whatever its valence. The median of the absolute values, over 0.6745, ignores creases and strays.
/// At most 16384 vertices, evenly spaced, are looked at.
///
/// Roughness of a clean surface at the scale of its edges cannot be told from noise and is included.
/// Pre:   as SurfaceGraph promises; the noise is independent from vertex to vertex.
/// Post:  finite, >= 0; 0 when no vertex has at least 9 vertices in its 2-ring.
/// Throws Cancelled.
/// Cost:  about 3 us for each vertex looked at.
[[nodiscard]] double estimate_noise(const SurfaceGraph& graph, const RunContext& context = {});

}  // namespace shapelight
