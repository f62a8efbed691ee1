#include "shapelight/render/field_colors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using Columns = std::array<const Column*, 3>;

Columns find_columns(const Geometry& geometry, const std::array<std::string_view, 3>& names) {
  Columns columns{};
  std::transform(names.begin(), names.end(), columns.begin(),
                 [&](auto name) { return geometry.attributes.find(name); });
  return columns;
}

bool all_present(const Columns& columns, const Geometry& geometry) {
  return std::all_of(columns.begin(), columns.end(),
                     [&](const Column* column) { return column != nullptr && column->size() == geometry.size(); });
}

/// What a full channel is in these columns: 16-bit colours are often 8-bit ones in disguise, floats 0 .. 255.
double full_channel(const Columns& columns) {
  double largest = 0.0;
  for (const Column* column : columns) {
    for (std::size_t i = 0; i < column->size(); ++i) largest = std::max(largest, column->as_double(i));
  }
  const ScalarType type = columns[0]->type();
  if (type == ScalarType::Float32 || type == ScalarType::Float64) return largest <= 1.0 ? 1.0 : 255.0;
  return largest <= 255.0 ? 255.0 : 65535.0;
}

std::vector<Color> combine(const Columns& columns, double scale, double offset) {
  std::vector<Color> colors(columns[0]->size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = scale * columns[c]->as_double(i) + offset;
      colors[i][c] = static_cast<float>(std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 0.5);
    }
  }
  return colors;
}

bool names_labels(std::string_view name) {
  constexpr std::array<std::string_view, 6> kNames = {"segment", "segments", "label",
                                                      "labels",  "class",    "classification"};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

Legend choose_legend(std::span<const double> values, std::string_view name) {
  Legend legend{std::string(name), ColorMap::Sequential, 0.0, 1.0};
  if (names_labels(name)) {
    legend.map = ColorMap::Categorical;
    return legend;
  }
  ValueRange range = value_range(values);
  if (name == "shape_index") range = {-1.0, 1.0};
  if (name == "reflectance" || (range.min < 0.0 && range.max > 0.0)) {
    legend.map = ColorMap::Diverging;
    const double reach = std::max(std::abs(range.min), std::abs(range.max));
    range = {-reach, reach};
  }
  legend.min = range.min;
  legend.max = range.max;
  return legend;
}

std::vector<Color> colors_of(const Legend& legend, std::span<const double> values) {
  std::vector<Color> colors(values.size());
  std::transform(values.begin(), values.end(), colors.begin(), [&](double v) {
    if (legend.map == ColorMap::Categorical)
      return distinct_color(std::isfinite(v) ? static_cast<std::int64_t>(v) : -1);
    return map_color(legend.map, std::isfinite(v) ? (v - legend.min) / (legend.max - legend.min) : std::nan(""));
  });
  return colors;
}

std::string available(const Geometry& geometry) {
  std::string names = "x, y, z";
  if (all_present(find_columns(geometry, {"red", "green", "blue"}), geometry)) names += ", rgb";
  if (all_present(find_columns(geometry, {"nx", "ny", "nz"}), geometry)) names += ", normal";
  for (const Column& column : geometry.attributes.columns()) names += ", " + column.name;
  return names;
}

}  // namespace

FieldColors color_by_values(std::span<const double> values, std::string_view name) {
  const Legend legend = choose_legend(values, name);
  return {colors_of(legend, values), legend};
}

FieldColors color_by_field(const Geometry& geometry, std::string_view field) {
  if (field == "rgb") {
    const Columns columns = find_columns(geometry, {"red", "green", "blue"});
    if (all_present(columns, geometry)) return {combine(columns, 1.0 / full_channel(columns), 0.0), {}};
  } else if (field == "normal") {
    const Columns columns = find_columns(geometry, {"nx", "ny", "nz"});
    if (all_present(columns, geometry)) return {combine(columns, 0.5, 0.5), {}};
  } else if (field == "x" || field == "y" || field == "z") {
    std::vector<double> values(geometry.size());
    std::transform(geometry.positions.begin(), geometry.positions.end(), values.begin(),
                   [axis = field[0] - 'x'](const Vec3& p) { return p[axis]; });
    const ValueRange range = value_range(values);  // a coordinate's zero means nothing: never diverging
    const Legend legend{std::string(field), ColorMap::Sequential, range.min, range.max};
    return {colors_of(legend, values), legend};
  } else if (const Column* column = geometry.attributes.find(field);
             column != nullptr && column->size() == geometry.size()) {
    return color_by_values(column->to_doubles(), field);
  }
  throw InvalidInput(fmt::format("color field '{}' is not there, expected one of: {}", field, available(geometry)));
}

}  // namespace shapelight
