#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats.hpp"
#include "io/text_scanner.hpp"

/// What the readers of text formats share: numbers in text have no type, so one is chosen that holds them exactly.
namespace shapelight::io {

/// Throws FormatError "format: path: message".
[[noreturn]] void fail_format(const Source& source, std::string_view format, std::string_view message);

/// A scanner over the file's text, behind a UTF-8 mark if there is one. Throws FormatError on an empty file and on
/// UTF-16 and UTF-32 text, which are named in the message.
[[nodiscard]] TextScanner open_text(const Source& source, std::string format);

/// Float32 when every number is exactly a float (or not a number), else Float64.
[[nodiscard]] ScalarType narrowest_float(std::span<const double> values);
[[nodiscard]] ScalarType narrowest_float(std::span<const Vec3> positions);

/// A column of the narrowest floating-point type.
[[nodiscard]] Column float_column(std::string name, std::vector<double> values);

/// Adds `names` (of one colour) as uint8 columns when all values are integers within 0 .. 255, else as float columns.
void set_colors(AttributeTable& table, std::span<const std::string_view> names,
                std::vector<std::vector<double>> values);

/// Turns "3 polygons with more than 3 corners were cut into triangles" and its like into a warning when `count` > 0.
void warn_count(Geometry& geometry, std::size_t count, std::string_view what);

/// ASCII only, which is all that keywords and column names need.
[[nodiscard]] std::string lower_case(std::string_view text);

}  // namespace shapelight::io
