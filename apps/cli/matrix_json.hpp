#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace shapelight::cli {

/// Row by row.
[[nodiscard]] inline nlohmann::ordered_json matrix_json(const Eigen::MatrixXd& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace shapelight::cli
