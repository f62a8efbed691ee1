#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>

#include "shapelight/core/error.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Throws InvalidInput unless there is one element per vertex.
inline void check_size(const SurfaceGraph& graph, std::size_t size, std::string_view name) {
  if (size != graph.size()) {
    throw InvalidInput(fmt::format("{}: {} values, expected one for each of {} vertices", name, size, graph.size()));
  }
}

/// Throws InvalidInput unless there is one finite value within [min, max] per vertex; names the first that is not.
inline void check_field(const SurfaceGraph& graph, std::span<const double> field, std::string_view name,
                        double min = -1e300, double max = 1e300) {
  check_size(graph, field.size(), name);
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!(field[i] >= min && field[i] <= max)) {
      throw InvalidInput(
          fmt::format("{}: vertex {}: {} is out of range, expected {:g} .. {:g}", name, i, field[i], min, max));
    }
  }
}

}  // namespace shapelight
