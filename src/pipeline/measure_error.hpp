#pragma once

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/triangle_mesh.hpp"
#include "shapelight/pipeline/simplify.hpp"

namespace shapelight::pipeline {

/// Distances between two surfaces, the larger of both directions.
[[nodiscard]] MeasuredError measure_error(const TriangleMesh& reference, const TriangleMesh& test,
                                          const RunContext& context);

}  // namespace shapelight::pipeline
