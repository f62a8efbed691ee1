#pragma once

#include "shapelight/core/run_context.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/pipeline/sample.hpp"

namespace shapelight {

/// sample() of a geometry whose graph has been built already; indices are those of the input.
[[nodiscard]] SampleResult sample_graph(const BuiltGraph& built, GeometryKind kind, const SampleSize& size,
                                        const SampleOptions& options, const RunContext& context);

}  // namespace shapelight
