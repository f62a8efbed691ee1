#include "io/narrow_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shapelight/core/error.hpp"

namespace shapelight::io {
namespace {

bool is_float(double value) {
  if (!std::isfinite(value)) return true;
  return std::abs(value) <= std::numeric_limits<float>::max() &&
         static_cast<double>(static_cast<float>(value)) == value;
}

bool is_byte(double value) { return value >= 0.0 && value <= 255.0 && value == std::floor(value); }

template <class T>
Column convert(std::string name, const std::vector<double>& values) {
  std::vector<T> converted(values.size());
  std::transform(values.begin(), values.end(), converted.begin(), [](double v) { return static_cast<T>(v); });
  return {std::move(name), std::move(converted)};
}

}  // namespace

void fail_format(const Source& source, std::string_view format, std::string_view message) {
  throw FormatError(fmt::format("{}: {}: {}", format, source.path.string(), message));
}

TextScanner open_text(const Source& source, std::string format) {
  std::string_view text = source.file.text();
  if (text.empty()) fail_format(source, format, "the file is empty, expected text");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const bool big = text.starts_with("\xFE\xFF") || text.starts_with(std::string_view("\0\0\xFE\xFF", 4));
  if (big || text.starts_with("\xFF\xFE")) {
    fail_format(source, format, "byte 0: the text is UTF-16 or UTF-32 encoded, expected ASCII or UTF-8");
  }
  return {text, std::move(format), source.path.string()};
}

ScalarType narrowest_float(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), is_float) ? ScalarType::Float32 : ScalarType::Float64;
}

ScalarType narrowest_float(std::span<const Vec3> positions) {
  const bool exact = std::all_of(positions.begin(), positions.end(),
                                 [](const Vec3& p) { return is_float(p.x()) && is_float(p.y()) && is_float(p.z()); });
  return exact ? ScalarType::Float32 : ScalarType::Float64;
}

Column float_column(std::string name, std::vector<double> values) {
  if (narrowest_float(values) == ScalarType::Float32) return convert<float>(std::move(name), values);
  return {std::move(name), std::move(values)};
}

void set_colors(AttributeTable& table, std::span<const std::string_view> names,
                std::vector<std::vector<double>> values) {
  const bool bytes = std::all_of(values.begin(), values.end(), [](const std::vector<double>& channel) {
    return std::all_of(channel.begin(), channel.end(), is_byte);
  });
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name(names[i]);
    table.set(bytes ? convert<std::uint8_t>(std::move(name), values[i])
                    : float_column(std::move(name), std::move(values[i])));
  }
}

void warn_count(Geometry& geometry, std::size_t count, std::string_view what) {
  if (count > 0) geometry.warnings.push_back(fmt::format("{} {}", count, what));
}

std::string lower_case(std::string_view text) {
  std::string lowered(text);
  std::transform(lowered.begin(), lowered.end(), lowered.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lowered;
}

}  // namespace shapelight::io
