#include <algorithm>

#include "io/text_writer.hpp"

namespace shapelight::io {
namespace {

// A name is one word, and must not be taken for a coordinate.
bool is_word(std::string_view name) {
  return !name.empty() && name.find_first_of(" \t\r\n,;\"") == std::string_view::npos && name != "x" && name != "y" &&
         name != "z";
}

}  // namespace

DroppedAttributes write_xyz(OutputFile& out, const Geometry& geometry, const WriteOptions&) {
  std::vector<const Column*> columns;
  Holds holds{.triangles = false};
  for (const Column& column : geometry.attributes.columns()) {
    if (!is_word(column.name)) continue;
    columns.push_back(&column);
    holds.columns.push_back(column.name);
  }
  TextWriter writer(out);
  if (!columns.empty()) {
    writer.text("# x y z");
    for (const Column* column : columns) {
      writer.text(" ");
      writer.text(column->name);
    }
    writer.end_line();
  }
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    writer.point(geometry.positions[i], geometry.coordinate_type);
    for (const Column* column : columns) {
      writer.text(" ");
      writer.value(*column, i);
    }
    writer.end_line();
  }
  writer.finish();
  return left_out(geometry, holds);
}

}  // namespace shapelight::io
