#include "io/point_welder.hpp"
#include "io/text_writer.hpp"

namespace shapelight::io {
namespace {

// OBJ colours are within 0 .. 1; integer columns span their type's range.
float unit_color(const Column& column, std::size_t i) {
  const double full = column.type() == ScalarType::UInt8 ? 255.0 : column.type() == ScalarType::UInt16 ? 65535.0 : 1.0;
  return static_cast<float>(column.as_double(i) / full);
}

void write_vertices(TextWriter& writer, const Geometry& geometry, bool colors, bool normals) {
  const AttributeTable& table = geometry.attributes;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    writer.text("v ");
    writer.point(geometry.positions[i], geometry.coordinate_type);
    if (colors) {
      for (const std::string_view name : kColorNames) {
        writer.text(" ");
        writer.number(unit_color(*table.find(name), i));
      }
    }
    writer.end_line();
  }
  for (std::size_t i = 0; normals && i < geometry.size(); ++i) {
    writer.text("vn");
    for (const std::string_view name : kNormalNames) {
      writer.text(" ");
      writer.value(*table.find(name), i);
    }
    writer.end_line();
  }
}

// Equal texture coordinates are written once; returns the number of each corner's line.
std::vector<Index> write_texcoords(TextWriter& writer, const Geometry& geometry) {
  std::vector<Vec3> distinct;
  PointWelder welder(distinct);
  std::vector<Index> corners;
  corners.reserve(geometry.corner_texcoords.size());
  for (const auto& [u, v] : geometry.corner_texcoords) corners.push_back(welder.add(Vec3(u, v, 0.0)));
  for (const Vec3& uv : distinct) {
    writer.text("vt ");
    writer.number(static_cast<float>(uv.x()));
    writer.text(" ");
    writer.number(static_cast<float>(uv.y()));
    writer.end_line();
  }
  return corners;
}

}  // namespace

DroppedAttributes write_obj(OutputFile& out, const Geometry& geometry, const WriteOptions&) {
  const bool colors = has_columns(geometry.attributes, kColorNames);
  const bool normals = has_columns(geometry.attributes, kNormalNames);
  TextWriter writer(out);
  for (const std::string& comment : geometry.comments) {
    writer.text("# ");
    writer.text(comment);
    writer.end_line();
  }
  write_vertices(writer, geometry, colors, normals);
  const std::vector<Index> texcoords = write_texcoords(writer, geometry);
  for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
    writer.text("f");
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t vertex = geometry.triangles[t][k] + std::uint64_t{1};
      writer.text(" ");
      writer.number(vertex);
      if (!texcoords.empty() || normals) writer.text("/");
      if (!texcoords.empty()) writer.number(texcoords[3 * t + k] + std::uint64_t{1});
      if (!normals) continue;
      writer.text("/");
      writer.number(vertex);
    }
    writer.end_line();
  }
  writer.finish();
  Holds holds{.texcoords = true};
  if (colors) holds.columns.insert(holds.columns.end(), kColorNames.begin(), kColorNames.end());
  if (normals) holds.columns.insert(holds.columns.end(), kNormalNames.begin(), kNormalNames.end());
  return left_out(geometry, holds);
}

}  // namespace shapelight::io
