#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "io/formats.hpp"
#include "io/scalar_bytes.hpp"

namespace shapelight::io {
namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 20;
constexpr std::string_view kQuaternion = "viewpoint_quaternion ";

// What is written for each row: a point, or kNoIndex for a pixel in which nothing was seen.
struct Rows {
  std::vector<Index> points;
  std::size_t width = 0;
  std::size_t height = 1;
};

// Organised when the grid shows every point exactly once; pixels decide the order then.
Rows arrange(const Geometry& g) {
  Rows rows;
  if (g.grid && g.grid->height > 1) {
    std::vector<std::uint8_t> seen(g.size(), 0);
    std::size_t num_seen = 0;
    bool once = true;
    for (const Index i : g.grid->pixel) {
      if (i == kNoIndex) continue;
      once = once && std::exchange(seen[i], std::uint8_t{1}) == 0;
      ++num_seen;
    }
    if (once && num_seen == g.size()) return {g.grid->pixel, g.grid->width, g.grid->height};
  }
  rows.points.resize(g.size());
  for (std::size_t i = 0; i < g.size(); ++i) rows.points[i] = static_cast<Index>(i);
  rows.width = g.size();
  return rows;
}

const std::vector<std::uint8_t>* bytes_of(const Geometry& g, std::string_view name) {
  const Column* column = g.attributes.find(name);
  return column == nullptr ? nullptr : std::get_if<std::vector<std::uint8_t>>(&column->values);
}

// red, green, blue (and alpha) as the packed integer that PCL's viewers expect.
std::optional<Column> packed_color(const Geometry& g) {
  const auto* red = bytes_of(g, "red");
  const auto* green = bytes_of(g, "green");
  const auto* blue = bytes_of(g, "blue");
  const auto* alpha = bytes_of(g, "alpha");
  if (red == nullptr || green == nullptr || blue == nullptr) return std::nullopt;
  std::vector<std::uint32_t> packed(g.size());
  for (std::size_t i = 0; i < g.size(); ++i) {
    const std::uint32_t a = alpha == nullptr ? 0 : (*alpha)[i];
    packed[i] = a << 24 | std::uint32_t{(*red)[i]} << 16 | std::uint32_t{(*green)[i]} << 8 | (*blue)[i];
  }
  return Column{alpha == nullptr ? "rgb" : "rgba", std::move(packed)};
}

std::string field_name(const std::string& name) {
  if (name == "nx" || name == "ny" || name == "nz") return fmt::format("normal_{}", name[1]);
  std::string field = name;
  std::replace_if(
      field.begin(), field.end(), [](unsigned char c) { return c <= ' '; }, '_');
  return field.empty() || field == "_" ? "unnamed" : field;
}

char type_letter(ScalarType type) {
  if (is_float(type)) return 'F';
  return scalar_type_name(type).starts_with('u') ? 'U' : 'I';
}

std::vector<const Column*> fields_of(const Geometry& g, const std::optional<Column>& color,
                                     DroppedAttributes& dropped) {
  static constexpr std::array<std::string_view, 4> kPacked = {"red", "green", "blue", "alpha"};
  std::set<std::string> names = {"x", "y", "z", "X", "Y", "Z"};  // the reader takes capitals for coordinates, too
  std::vector<const Column*> fields;
  for (const Column& column : g.attributes.columns()) {
    const bool is_packed = color && column.type() == ScalarType::UInt8 &&
                           std::find(kPacked.begin(), kPacked.end(), column.name) != kPacked.end();
    if (is_packed && column.name != "red") continue;
    const Column& field = is_packed ? *color : column;
    if (field.size() == g.size() && names.insert(field_name(field.name)).second) {
      fields.push_back(&field);
    } else {
      dropped.push_back(column.name);
    }
  }
  if (!g.triangles.empty()) dropped.emplace_back("triangles");
  for (const Column& column : g.triangle_attributes.columns()) dropped.push_back(column.name);
  return fields;
}

std::string make_header(const Geometry& g, const Rows& rows, const std::vector<const Column*>& fields, bool ascii) {
  const bool is_float32 = g.coordinate_type == ScalarType::Float32;
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
  std::string quaternion = "1 0 0 0";
  for (std::string comment : g.comments) {
    std::replace_if(
        comment.begin(), comment.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    if (comment.starts_with(kQuaternion)) {
      quaternion = comment.substr(kQuaternion.size());
    } else {
      text += "# " + comment + '\n';
    }
  }
  std::string names = "FIELDS x y z";
  std::string sizes = is_float32 ? "SIZE 4 4 4" : "SIZE 8 8 8";
  std::string types = "TYPE F F F", counts = "COUNT 1 1 1";
  for (const Column* field : fields) {
    names += ' ' + field_name(field->name);
    sizes += fmt::format(" {}", scalar_type_size(field->type()));
    types += fmt::format(" {}", type_letter(field->type()));
    counts += " 1";
  }
  const Vec3 viewpoint = g.viewpoint.value_or(Vec3::Zero());
  text += fmt::format("VERSION 0.7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT {}\n", names, sizes, types, counts, rows.width,
                      rows.height);
  text += fmt::format("VIEWPOINT {} {} {} {}\nPOINTS {}\nDATA {}\n", viewpoint.x(), viewpoint.y(), viewpoint.z(),
                      quaternion, rows.points.size(), ascii ? "ascii" : "binary");
  return text;
}

template <class T>
void put(std::string& buffer, T value, bool ascii) {
  if (ascii) {
    fmt::format_to(std::back_inserter(buffer), "{} ", value);
  } else {
    append_bytes(buffer, value);
  }
}

void put_point(std::string& buffer, const Geometry& g, const std::vector<const Column*>& fields, Index i, bool ascii) {
  const Vec3 position = i == kNoIndex ? Vec3::Constant(std::numeric_limits<double>::quiet_NaN()) : g.positions[i];
  for (const double coordinate : position) {
    if (g.coordinate_type == ScalarType::Float32) {
      put(buffer, static_cast<float>(coordinate), ascii);
    } else {
      put(buffer, coordinate, ascii);
    }
  }
  for (const Column* field : fields) {
    std::visit([&]<class T>(const std::vector<T>& values) { put(buffer, i == kNoIndex ? T{} : values[i], ascii); },
               field->values);
  }
  if (ascii) buffer.back() = '\n';
}

}  // namespace

DroppedAttributes write_pcd(OutputFile& out, const Geometry& geometry, const WriteOptions& options) {
  DroppedAttributes dropped;
  const std::optional<Column> color = packed_color(geometry);
  const std::vector<const Column*> fields = fields_of(geometry, color, dropped);
  const Rows rows = arrange(geometry);
  out.write(make_header(geometry, rows, fields, options.ascii));
  std::string buffer;
  for (const Index i : rows.points) {
    put_point(buffer, geometry, fields, i, options.ascii);
    if (buffer.size() < kFlushBytes) continue;
    out.write(buffer);
    buffer.clear();
  }
  out.write(buffer);
  return dropped;
}

}  // namespace shapelight::io
