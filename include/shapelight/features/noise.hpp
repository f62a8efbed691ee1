#pragma once

#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Robust estimate of the measurement noise: standard deviation along the normal, [input length unit].
///
/// Every vertex is compared with the quadric that fits it and the 12 nearest vertices of its 2-ring best. The residual
/// of a least-squares fit has the standard deviation sigma sqrt(1 - h), h being the vertex's own leverage, so dividing
/// by that calibrates each vertex exactly, whatever its valence. The median of the absolute values, over 0.6745,
/// ignores creases and strays. At most 16384 vertices, evenly spaced, are looked at.
///
/// Accuracy on planes, spheres, tori and saddles, meshes and 12-nearest-neighbour clouds, by multiples of the mean edge
/// length h: within 5 % from 0.02 h to 0.2 h of noise, 2 to 13 % too much at 0.5 h; below 0.001 h when clean. Roughness
/// of a real surface at the scale of its edges cannot be told from noise and is included: 0.01 h to 0.05 h on scanned
/// models. Pre:   as SurfaceGraph promises; the noise is independent from vertex to vertex. Post:  finite, >= 0; 0 when
/// no vertex has at least 9 vertices in its 2-ring. Throws Cancelled. Cost:  about 3 us for each vertex looked at.
[[nodiscard]] double estimate_noise(const SurfaceGraph& graph, const RunContext& context = {});

}  // namespace shapelight
