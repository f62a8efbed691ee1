#pragma once

#include <nlohmann/json.hpp>

#include "shapelight/core/types.hpp"

namespace shapelight::cli {

/// 4 rows of 4.
[[nodiscard]] inline nlohmann::ordered_json transform_json(const RigidTransform& transform) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  const Eigen::Matrix4d m = transform.matrix();
  for (int r = 0; r < 4; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
  return rows;
}

}  // namespace shapelight::cli
