#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "io/formats.hpp"
#include "io/scalar_bytes.hpp"

namespace shapelight::io {
namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 20;

// The names that all readers know; 64-bit integers are an extension that several of them share.
std::string_view ply_type_name(ScalarType type) {
  switch (type) {
    case ScalarType::Int8:
      return "char";
    case ScalarType::UInt8:
      return "uchar";
    case ScalarType::Int16:
      return "short";
    case ScalarType::UInt16:
      return "ushort";
    case ScalarType::Int32:
      return "int";
    case ScalarType::UInt32:
      return "uint";
    case ScalarType::Float32:
      return "float";
    case ScalarType::Float64:
      return "double";
    default:
      return scalar_type_name(type);
  }
}

// Appends values to rows and rows to the file, in either encoding.
class RowWriter {
 public:
  RowWriter(OutputFile& out, bool ascii) : out_(out), ascii_(ascii) {}

  template <class T>
  void put(T value) {
    if (ascii_) {
      fmt::format_to(std::back_inserter(buffer_), "{}{}", row_begun_ ? " " : "", value);
      row_begun_ = true;
    } else {
      append_bytes(buffer_, value);
    }
  }
  void put(const Column& column, std::size_t i) {
    std::visit([&](const auto& values) { put(values[i]); }, column.values);
  }
  void end_row() {
    if (ascii_) buffer_ += '\n';
    row_begun_ = false;
    if (buffer_.size() >= kFlushBytes) flush();
  }
  void flush() {
    out_.write(buffer_);
    buffer_.clear();
  }

 private:
  OutputFile& out_;
  bool ascii_;
  bool row_begun_ = false;
  std::string buffer_;
};

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string property_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c <= ' '; }, '_');
  return name.empty() ? "unnamed" : name;
}

// The columns that can be stored beside the properties that the element has anyway (`names`).
std::vector<const Column*> storable(const AttributeTable& table, std::size_t size, std::set<std::string> names,
                                    DroppedAttributes& dropped) {
  std::vector<const Column*> columns;
  for (const Column& column : table.columns()) {
    if (column.size() != size || !names.insert(property_name(column.name)).second) {
      dropped.push_back(column.name);
    } else {
      columns.push_back(&column);
    }
  }
  return columns;
}

void add_properties(std::string& header, const std::vector<const Column*>& columns) {
  for (const Column* c : columns) {
    header += fmt::format("property {} {}\n", ply_type_name(c->type()), property_name(c->name));
  }
}

// Lines that the reader takes for the grid or the viewpoint must not come from free text.
bool is_obj_info(const std::string& comment) {
  return comment.starts_with("obj_info ") && !comment.starts_with("obj_info num_") &&
         !comment.starts_with("obj_info viewpoint");
}

struct Layout {
  std::vector<const Column*> vertex_columns;
  std::vector<const Column*> face_columns;
  bool has_texcoords = false;
};

std::string make_header(const Geometry& g, const Layout& layout, bool ascii) {
  std::string header = fmt::format("ply\nformat {} 1.0\n", ascii ? "ascii" : "binary_little_endian");
  for (const std::string& comment : g.comments) {
    header += is_obj_info(comment) ? one_line(comment) : "comment " + one_line(comment);
    header += '\n';
  }
  if (g.viewpoint) {
    header += fmt::format("obj_info viewpoint {} {} {}\n", g.viewpoint->x(), g.viewpoint->y(), g.viewpoint->z());
  }
  if (g.grid) header += fmt::format("obj_info num_cols {}\nobj_info num_rows {}\n", g.grid->width, g.grid->height);
  header += fmt::format("element vertex {}\n", g.size());
  const std::string_view real = g.coordinate_type == ScalarType::Float32 ? "float" : "double";
  for (const char axis : {'x', 'y', 'z'}) header += fmt::format("property {} {}\n", real, axis);
  add_properties(header, layout.vertex_columns);
  if (!g.triangles.empty()) {
    header += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", g.triangles.size());
    if (layout.has_texcoords) header += "property list uchar float texcoord\n";
    add_properties(header, layout.face_columns);
  }
  if (g.grid) {
    header += fmt::format("element range_grid {}\nproperty list uchar int vertex_indices\n", g.grid->pixel.size());
  }
  return header + "end_header\n";
}

void write_vertices(RowWriter& rows, const Geometry& g, const Layout& layout) {
  for (std::size_t i = 0; i < g.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (g.coordinate_type == ScalarType::Float32) {
        rows.put(static_cast<float>(g.positions[i][axis]));
      } else {
        rows.put(g.positions[i][axis]);
      }
    }
    for (const Column* column : layout.vertex_columns) rows.put(*column, i);
    rows.end_row();
  }
}

void write_faces(RowWriter& rows, const Geometry& g, const Layout& layout) {
  for (std::size_t t = 0; t < g.triangles.size(); ++t) {
    rows.put(std::uint8_t{3});
    for (const Index corner : g.triangles[t]) rows.put(static_cast<std::int32_t>(corner));
    if (layout.has_texcoords) {
      rows.put(std::uint8_t{6});
      for (std::size_t c = 3 * t; c < 3 * t + 3; ++c) {
        for (const float coordinate : g.corner_texcoords[c]) rows.put(coordinate);
      }
    }
    for (const Column* column : layout.face_columns) rows.put(*column, t);
    rows.end_row();
  }
}

void write_grid(RowWriter& rows, const RangeGrid& grid) {
  for (const Index pixel : grid.pixel) {
    rows.put(static_cast<std::uint8_t>(pixel == kNoIndex ? 0 : 1));
    if (pixel != kNoIndex) rows.put(static_cast<std::int32_t>(pixel));
    rows.end_row();
  }
}

}  // namespace

DroppedAttributes write_ply(OutputFile& out, const Geometry& geometry, const WriteOptions& options) {
  DroppedAttributes dropped;
  Layout layout;
  layout.vertex_columns = storable(geometry.attributes, geometry.size(), {"x", "y", "z"}, dropped);
  layout.face_columns = storable(geometry.triangle_attributes, geometry.triangles.size(),
                                 {"vertex_indices", "vertex_index", "texcoord"}, dropped);
  layout.has_texcoords =
      !geometry.corner_texcoords.empty() && geometry.corner_texcoords.size() == 3 * geometry.triangles.size();
  out.write(make_header(geometry, layout, options.ascii));
  RowWriter rows(out, options.ascii);
  write_vertices(rows, geometry, layout);
  write_faces(rows, geometry, layout);
  if (geometry.grid) write_grid(rows, *geometry.grid);
  rows.flush();
  return dropped;
}

}  // namespace shapelight::io
