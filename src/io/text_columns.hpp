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
/// (int8 to int16, ... int64). The coordinates x, y, z are read as float64 even where float32 is declared; when the
/// text of one says more than float32 holds, all three stay so.
class TextColumn {
 public:
  TextColumn(std::string name, ScalarType type, std::size_t expected);

  /// Throws FormatError, through the scanner, when the token is no such number.
  void append(const TextScanner& scanner, std::string_view token);
  /// The columns, which are moved from; adds to `warnings` where they are wider than declared.
  [[nodiscard]] static std::vector<Column> finish(std::vector<TextColumn>& columns, std::vector<std::string>& warnings);

 private:
  template <class T>
  bool append_integer(std::vector<T>& values, std::string_view token);
  void widen();

  Column column_;
  ScalarType declared_;
  bool is_trial_;              // declared float32, held as float64
  bool keeps_float32_ = true;  // of the values so far
};

/// Moves the columns x, y, z out of `columns` into the geometry's positions. coordinate_type becomes Float32 when all
/// three fit float32 exactly (float32, or integers of at most 16 bits), else Float64. False when one is missing.
bool take_positions(std::vector<Column>& columns, Geometry& geometry);

}  // namespace shapelight::io
