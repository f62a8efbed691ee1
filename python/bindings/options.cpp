#include "options.hpp"

#include <nanobind/stl/string.h>

#include <algorithm>

namespace shapelight::python {

std::string keyword_of(const OptionInfo& info) {
  std::string keyword(info.name);
  std::replace(keyword.begin(), keyword.end(), '-', '_');
  if (keyword == "lambda") keyword += '_';  // a reserved word
  return keyword;
}

void refuse(const OptionInfo& info, nb::handle value, std::string_view expected) {
  throw InvalidInput(fmt::format("{}: {}, expected {}", keyword_of(info), nb::repr(value).c_str(), expected));
}

void add_option_row(nb::list& table, const OptionInfo& info, nb::object type, nb::object default_value,
                    nb::object choices) {
  nb::dict row;
  row["name"] = keyword_of(info);
  row["type"] = type;
  row["default"] = default_value;
  row["choices"] = choices;
  row["unit"] = std::string(info.unit);
  row["meaning"] = std::string(info.meaning);
  row["min"] = info.min;
  row["max"] = info.max;
  table.append(row);
}

}  // namespace shapelight::python
