#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace shapelight {

using Color = std::array<float, 3>;  ///< red, green, blue in [0, 1]; sRGB

/// Maps from a number to a colour. Each one is a path through OKLab (Ottosson 2020) walked at constant speed, so that
/// equal steps of the number look equally large; lightness alone already orders the values, so readers with any
/// colour vision, and black-and-white prints, keep the order.
enum class ColorMap : std::uint8_t {
  Sequential,   ///< dark violet, blue, teal, green, yellow: lightness rises throughout
  BlueYellow,   ///< dark blue, grey, yellow: the same with only the hues that red-green blind readers tell apart
  Diverging,    ///< blue, near-white, orange: lightness falls equally to both sides of the middle
  Categorical,  ///< the number is a label; see distinct_color()
};

[[nodiscard]] constexpr auto enum_names(ColorMap) {
  return std::array<std::pair<ColorMap, std::string_view>, 4>{{{ColorMap::Sequential, "sequential"},
                                                               {ColorMap::BlueYellow, "blue-yellow"},
                                                               {ColorMap::Diverging, "diverging"},
                                                               {ColorMap::Categorical, "categorical"}}};
}

/// Colour at t in [0, 1]; clamped outside, grey for NaN. Pre: map is not Categorical.
[[nodiscard]] Color map_color(ColorMap map, double t);

/// Colour of a label: hue steps by the golden angle, lightness by a cycle of three, so that labels that follow each
/// other differ clearly. Negative labels ("none") are grey.
[[nodiscard]] Color distinct_color(std::int64_t label);

/// OKLab (lightness in [0, 1], a, b) of a colour and back; back clips to what sRGB can show.
[[nodiscard]] std::array<double, 3> to_oklab(const Color& color);
[[nodiscard]] Color from_oklab(const std::array<double, 3>& lab);

/// One channel from sRGB to linear light and back, both in [0, 1].
[[nodiscard]] double srgb_to_linear(double value);
[[nodiscard]] double linear_to_srgb(double value);

struct ValueRange {
  double min = 0.0;
  double max = 1.0;
};
/// The 1st to 99th percentile of the finite values, so that a few outliers do not use up the colours. Never empty:
/// a constant field c gives [c - 0.5, c + 0.5], no finite value [0, 1]. Cost: O(n).
[[nodiscard]] ValueRange value_range(std::span<const double> values);

}  // namespace shapelight
