#pragma once

#include <fmt/compile.h>
#include <fmt/format.h>

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "io/formats.hpp"

namespace shapelight::io {

/// Buffered text output. Numbers are written in the shortest form that reads back to the same value of their type.
class TextWriter {
 public:
  explicit TextWriter(OutputFile& out) : out_(out) {}

  void text(std::string_view words) { buffer_.append(words.data(), words.data() + words.size()); }
  template <class T>
  void number(T value) {
    fmt::format_to(fmt::appender(buffer_), FMT_COMPILE("{}"), value);
  }
  /// A number that cannot be taken for an integer: "1.0".
  void real(float value) { fmt::format_to(fmt::appender(buffer_), "{:#}", value); }
  /// "x y z", each as a float or a double.
  void point(const Vec3& p, ScalarType type);
  /// Value i of a column.
  void value(const Column& column, std::size_t i);
  /// Ends the line and passes full buffers on.
  void end_line();
  /// Passes on what is left; to be called last.
  void finish();

 private:
  OutputFile& out_;
  fmt::memory_buffer buffer_;
};

/// Which parts of a geometry a format can hold beside point coordinates.
struct Holds {
  std::vector<std::string_view> columns = {};
  bool triangles = true;
  bool texcoords = false;
};

/// Names of what the geometry has and the format cannot hold: point columns by name, "triangle.NAME" for columns of
/// triangles, and "triangles", "texcoords", "grid", "viewpoint".
[[nodiscard]] DroppedAttributes left_out(const Geometry& geometry, const Holds& holds);

/// True when the table has all of the columns.
[[nodiscard]] bool has_columns(const AttributeTable& table, std::span<const std::string_view> names);

inline constexpr std::array<std::string_view, 3> kNormalNames = {"nx", "ny", "nz"};
inline constexpr std::array<std::string_view, 3> kColorNames = {"red", "green", "blue"};

}  // namespace shapelight::io
