#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "shapelight/data/attributes.hpp"

namespace shapelight::cli {

/// --keep and --drop: which attributes travel. All do unless one of the two says otherwise.
struct AttributeChoice {
  std::vector<std::string> keep, drop;

  void add_options(CLI::App& command);
  /// Removes what shall not travel and returns its names. Throws InvalidInput for a name that is not there.
  std::vector<std::string> apply(AttributeTable& table) const;
};

}  // namespace shapelight::cli
