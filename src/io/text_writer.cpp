#include "io/text_writer.hpp"

#include <algorithm>

namespace shapelight::io {

void TextWriter::point(const Vec3& p, ScalarType type) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) text(" ");
    if (type == ScalarType::Float32) {
      number(static_cast<float>(p[axis]));
    } else {
      number(p[axis]);
    }
  }
}

void TextWriter::value(const Column& column, std::size_t i) {
  std::visit([&](const auto& values) { number(values[i]); }, column.values);
}

void TextWriter::end_line() {
  constexpr std::size_t kFull = 1 << 16;
  buffer_.push_back('\n');
  if (buffer_.size() >= kFull) finish();
}

void TextWriter::finish() {
  out_.write(buffer_.data(), buffer_.size());
  buffer_.clear();
}

DroppedAttributes left_out(const Geometry& geometry, const Holds& holds) {
  DroppedAttributes names;
  for (const Column& column : geometry.attributes.columns()) {
    if (std::find(holds.columns.begin(), holds.columns.end(), column.name) == holds.columns.end()) {
      names.push_back(column.name);
    }
  }
  if (!geometry.triangles.empty() && !holds.triangles) names.emplace_back("triangles");
  for (const Column& column : geometry.triangle_attributes.columns()) names.push_back("triangle." + column.name);
  if (!geometry.corner_texcoords.empty() && !holds.texcoords) names.emplace_back("texcoords");
  if (geometry.grid) names.emplace_back("grid");
  if (geometry.viewpoint) names.emplace_back("viewpoint");
  return names;
}

bool has_columns(const AttributeTable& table, std::span<const std::string_view> names) {
  return std::all_of(names.begin(), names.end(), [&](std::string_view name) { return table.find(name) != nullptr; });
}

}  // namespace shapelight::io
