#include "io/text_writer.hpp"

namespace shapelight::io {
namespace {

// Geomview wants all four channels: integers within 0 .. 255, or reals with a point within 0 .. 1.
void write_color(TextWriter& writer, const AttributeTable& table, std::size_t i) {
  const Column* alpha = table.find("alpha");
  const bool bytes = table.find("red")->type() == ScalarType::UInt8;
  const auto channel = [&](double value) {
    writer.text(" ");
    bytes ? writer.number(static_cast<int>(value)) : writer.real(static_cast<float>(value));
  };
  for (const std::string_view name : kColorNames) channel(table.find(name)->as_double(i));
  channel(alpha != nullptr ? alpha->as_double(i) : bytes ? 255.0 : 1.0);
}

// Channels of one type that the format knows: bytes or floats.
bool has_writable_colors(const AttributeTable& table) {
  if (!has_columns(table, kColorNames)) return false;
  const ScalarType type = table.find("red")->type();
  const Column* alpha = table.find("alpha");
  return (type == ScalarType::UInt8 || type == ScalarType::Float32) && table.find("green")->type() == type &&
         table.find("blue")->type() == type && (alpha == nullptr || alpha->type() == type);
}

}  // namespace

DroppedAttributes write_off(OutputFile& out, const Geometry& geometry, const WriteOptions&) {
  const AttributeTable& table = geometry.attributes;
  const bool colors = has_writable_colors(table);
  const bool normals = has_columns(table, kNormalNames);
  TextWriter writer(out);
  writer.text(colors ? "C" : "");
  writer.text(normals ? "NOFF\n" : "OFF\n");
  writer.number(geometry.size());
  writer.text(" ");
  writer.number(geometry.triangles.size());
  writer.text(" 0");
  writer.end_line();
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    writer.point(geometry.positions[i], geometry.coordinate_type);
    for (std::size_t k = 0; normals && k < 3; ++k) {
      writer.text(" ");
      writer.value(*table.find(kNormalNames[k]), i);
    }
    if (colors) write_color(writer, table, i);
    writer.end_line();
  }
  for (const Triangle& triangle : geometry.triangles) {
    writer.text("3");
    for (const Index vertex : triangle) {
      writer.text(" ");
      writer.number(vertex);
    }
    writer.end_line();
  }
  writer.finish();
  Holds holds;
  if (colors) holds.columns = {"red", "green", "blue", "alpha"};
  if (normals) holds.columns.insert(holds.columns.end(), kNormalNames.begin(), kNormalNames.end());
  return left_out(geometry, holds);
}

}  // namespace shapelight::io
