#pragma once

#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/graph/build_graph.hpp"

namespace shapelight {

/// A BuiltGraph with position, origin, global_id and vertex_of_point filled: the distinct finite positions in Morton
/// order, ties by (x, y, z), so that neither the order of the input nor its duplicates can change any later result.
/// Every other array is sized, or empty when its size depends on edges.
[[nodiscard]] BuiltGraph start_graph(std::span<const Vec3> positions, const RunContext& context);

}  // namespace shapelight
