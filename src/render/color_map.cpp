#include "shapelight/render/color_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace shapelight {
namespace {

using Lab = std::array<double, 3>;
constexpr Color kNoValue = {0.62F, 0.62F, 0.62F};
constexpr std::size_t kTableSize = 257;
using Table = std::array<Color, kTableSize>;

Lab from_lch(double lightness, double chroma, double hue_degrees) {
  const double hue = hue_degrees * std::numbers::pi / 180.0;
  return {lightness, chroma * std::cos(hue), chroma * std::sin(hue)};
}

std::array<double, 3> oklab_to_linear(const Lab& lab) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2]);
  const double m = cube(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2]);
  const double s = cube(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2]);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

/// The colour itself, or the most colourful one of the same lightness and hue that sRGB can show.
Color to_gamut(Lab lab) {
  for (int step = 0; step < 64; ++step) {
    const auto rgb = oklab_to_linear(lab);
    if (std::all_of(rgb.begin(), rgb.end(), [](double c) { return c >= -1e-4 && c <= 1.0001; })) break;
    lab[1] *= 0.97;
    lab[2] *= 0.97;
  }
  return from_oklab(lab);
}

double distance(const Lab& a, const Lab& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// Fills the entries first .. last by walking the polyline through the control points at constant speed in OKLab.
void walk(const std::vector<Lab>& points, std::size_t first, std::size_t last, Table& table) {
  std::vector<double> arc = {0.0};
  for (std::size_t i = 1; i < points.size(); ++i) arc.push_back(arc.back() + distance(points[i - 1], points[i]));
  std::size_t segment = 1;
  for (std::size_t k = first; k <= last; ++k) {
    const double at = arc.back() * static_cast<double>(k - first) / static_cast<double>(last - first);
    while (segment + 1 < points.size() && arc[segment] < at) ++segment;
    const double u = std::clamp((at - arc[segment - 1]) / (arc[segment] - arc[segment - 1]), 0.0, 1.0);
    Lab lab;
    for (std::size_t c = 0; c < 3; ++c) lab[c] = (1.0 - u) * points[segment - 1][c] + u * points[segment][c];
    table[k] = to_gamut(lab);
  }
}

Table whole_walk(const std::vector<Lab>& points) {
  Table table{};
  walk(points, 0, kTableSize - 1, table);
  return table;
}

/// Two walks away from the middle, which is thus the middle whatever the lengths of the arms.
Table two_walks(const std::vector<Lab>& below, const std::vector<Lab>& above) {
  Table table{};
  walk(below, 0, kTableSize / 2, table);
  walk(above, kTableSize / 2, kTableSize - 1, table);
  return table;
}

const Table& table_of(ColorMap map) {
  static const Table sequential = whole_walk(
      {from_lch(0.26, 0.09, 305), from_lch(0.34, 0.12, 285), from_lch(0.43, 0.115, 258), from_lch(0.53, 0.10, 225),
       from_lch(0.63, 0.105, 185), from_lch(0.73, 0.135, 153), from_lch(0.82, 0.165, 125), from_lch(0.92, 0.17, 103)});
  static const Table blue_yellow =
      whole_walk({from_lch(0.25, 0.08, 262), from_lch(0.36, 0.075, 262), from_lch(0.55, 0.012, 262),
                  from_lch(0.74, 0.08, 95), from_lch(0.92, 0.15, 95)});
  static const Lab middle = from_lch(0.965, 0.004, 150);
  static const Table diverging =
      two_walks({from_lch(0.42, 0.13, 258), from_lch(0.62, 0.12, 248), from_lch(0.80, 0.07, 240), middle},
                {middle, from_lch(0.80, 0.09, 62), from_lch(0.62, 0.15, 48), from_lch(0.42, 0.13, 38)});
  switch (map) {
    case ColorMap::BlueYellow:
      return blue_yellow;
    case ColorMap::Diverging:
      return diverging;
    default:
      return sequential;
  }
}

}  // namespace

double srgb_to_linear(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double linear_to_srgb(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
}

Lab to_oklab(const Color& color) {
  const double r = srgb_to_linear(color[0]);
  const double g = srgb_to_linear(color[1]);
  const double b = srgb_to_linear(color[2]);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Color from_oklab(const Lab& lab) {
  const auto linear = oklab_to_linear(lab);
  Color color;
  for (std::size_t c = 0; c < 3; ++c) color[c] = static_cast<float>(linear_to_srgb(std::clamp(linear[c], 0.0, 1.0)));
  return color;
}

Color map_color(ColorMap map, double t) {
  if (std::isnan(t)) return kNoValue;
  const Table& table = table_of(map);
  const double at = std::clamp(t, 0.0, 1.0) * (kTableSize - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), kTableSize - 2);
  const float u = static_cast<float>(at - static_cast<double>(below));
  Color color;
  for (std::size_t c = 0; c < 3; ++c) color[c] = (1.0F - u) * table[below][c] + u * table[below + 1][c];
  return color;
}

Color distinct_color(std::int64_t label) {
  if (label < 0) return kNoValue;
  constexpr double kGoldenAngle = 137.50776405003785;
  constexpr std::array<double, 3> kLightness = {0.66, 0.80, 0.53};
  const double hue = std::fmod(static_cast<double>(label) * kGoldenAngle + 250.0, 360.0);
  return to_gamut(from_lch(kLightness[static_cast<std::size_t>(label % 3)], 0.135, hue));
}

ValueRange value_range(std::span<const double> values) {
  std::vector<double> finite;
  finite.reserve(values.size());
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  if (finite.empty()) return {};
  const auto at = [&](double share) {
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(finite.size() - 1) + 0.5);
    std::nth_element(finite.begin(), finite.begin() + rank, finite.end());
    return finite[static_cast<std::size_t>(rank)];
  };
  ValueRange range{at(0.01), at(0.99)};
  if (range.min == range.max) {
    // Rare values beside a constant majority (a mask, a count) still deserve a colour.
    const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
    range = {*low, *high};
  }
  if (range.min == range.max) return {range.min - 0.5, range.max + 0.5};
  return range;
}

}  // namespace shapelight
