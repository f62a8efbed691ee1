#pragma once

#include <optional>

#include "shapelight/core/run_context.hpp"
#include "shapelight/graph/build_graph.hpp"

namespace shapelight {

/// Fills what all builders share once edges, areas, boundary and outlier flags are there: totals, mean edge length,
/// the flag of isolated vertices far from all others, and the counts.
void finish_graph(BuiltGraph& built, const RunContext& context);

/// Turns the normals of every connected component, as a whole, towards the viewpoint (input frame) or, without one,
/// away from the component's centre. For a closed surface the latter is the sign of its volume (divergence theorem);
/// an open one is taken to bulge towards the outside. A component that is nearly flat looks to +z.
void orient_components(SurfaceGraph& graph, const std::optional<Vec3>& viewpoint, const RunContext& context);

/// The same for all components together, each about its own centre: when they are wound alike, as the pixels of one
/// range image are.
void orient_as_one(SurfaceGraph& graph, const std::optional<Vec3>& viewpoint, const RunContext& context);

}  // namespace shapelight
