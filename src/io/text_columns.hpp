#pragma once

#include <string_view>

#include "io/text_scanner.hpp"
#include "shapelight/data/geometry.hpp"

/// Columns of numbers in text, and coordinates made of columns: what text and binary formats with named scalars share.
namespace shapelight::io {

/// True when a float32 prints as `token` does, to the token's last digit. False means that the text is more precise
/// than the float32 that a header may have declared for it, as with UTM coordinates. Pre: value is that of the token.
[[nodiscard]] bool float32_keeps(std::string_view token, double value);

/// A column that grows by tokens. An integer outside the declared type widens the column to the next signed type
/// (int8 to int16, ... int64); wide_floats reads float32 as float64 until finish() knows that float32 was enough.
class TextColumn {
 public:
  TextColumn(std::string name, ScalarType type, std::size_t expected, bool wide_floats = false);

  /// Throws FormatError, through the scanner, when the token is no such number.
  void append(const TextScanner& scanner, std::string_view token);
  /// The column; adds to `warnings` when it is wider than declared.
  [[nodiscard]] Column finish(std::vector<std::string>& warnings);

 private:
  template <class T>
  bool append_integer(std::vector<T>& values, std::string_view token);
  void widen();

  Column column_;
  ScalarType declared_;
  bool keeps_float32_;
};

/// Moves the columns x, y, z out of `columns` into the geometry's positions. coordinate_type becomes Float32 when all
/// three fit float32 exactly (float32, or integers of at most 16 bits), else Float64. False when one is missing.
bool take_positions(std::vector<Column>& columns, Geometry& geometry);

}  // namespace shapelight::io
