#include "attribute_choice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "shapelight/core/error.hpp"

namespace shapelight::cli {
namespace {

void require_known(const AttributeTable& table, const std::vector<std::string>& names, std::string_view option) {
  for (const std::string& name : names) {
    if (table.find(name) != nullptr) continue;
    std::string known;
    for (const Column& column : table.columns()) known += fmt::format("{}{}", known.empty() ? "" : ", ", column.name);
    throw InvalidInput(
        fmt::format("--{}: no attribute '{}', expected one of: {}", option, name, known.empty() ? "(none)" : known));
  }
}

}  // namespace

void AttributeChoice::add_options(CLI::App& command) {
  command.add_option("--keep", keep, "Only these attributes travel (all do by default).")
      ->type_name("NAME")
      ->delimiter(',');
  command.add_option("--drop", drop, "These attributes are left out.")->type_name("NAME")->delimiter(',');
}

std::vector<std::string> AttributeChoice::apply(AttributeTable& table) const {
  require_known(table, keep, "keep");
  require_known(table, drop, "drop");
  std::vector<std::string> dropped;
  for (const Column& column : table.columns()) {
    const auto listed = [&](const std::vector<std::string>& names) {
      return std::find(names.begin(), names.end(), column.name) != names.end();
    };
    if (listed(drop) || (!keep.empty() && !listed(keep))) dropped.push_back(column.name);
  }
  for (const std::string& name : dropped) table.remove(name);
  return dropped;
}

}  // namespace shapelight::cli
