#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shapelight/data/geometry.hpp"
#include "shapelight/render/color_map.hpp"

namespace shapelight {

/// What a picture's colour bar says.
struct Legend {
  std::string name;
  ColorMap map = ColorMap::Sequential;
  double min = 0.0;  ///< value of the first colour
  double max = 1.0;  ///< value of the last colour
};

struct FieldColors {
  std::vector<Color> colors;  ///< one per point; grey where the field is not finite
  Legend legend;              ///< name is empty where a colour bar says nothing: "rgb", "normal"
};

/// Colours of a field of one value per point. The map follows from the field: shape_index and reflectance, and every
/// field whose 1st and 99th percentiles differ in sign, diverge around 0; labels (columns named segment,
/// label, class or classification) are categorical; all others are sequential. The range is value_range(), symmetric
/// when diverging, and exactly [-1, 1] for shape_index.
[[nodiscard]] FieldColors color_by_values(std::span<const double> values, std::string_view name);

/// Colours by a named column of geometry.attributes, or by "rgb" (columns red, green, blue: 8 or 16 bits, or floats),
/// "normal" (columns nx, ny, nz), "x", "y", "z". Throws InvalidInput that lists the fields there are.
[[nodiscard]] FieldColors color_by_field(const Geometry& geometry, std::string_view field);

}  // namespace shapelight
