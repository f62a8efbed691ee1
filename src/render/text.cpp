#include "render/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace shapelight::drawing {
namespace {

/// Strokes of ' ' to '~': polylines through points "xy" on a grid 5 wide and 10 high; the baseline is y = 2, small
/// letters reach 6, capitals 8. A point given twice is a dot.
// clang-format off
constexpr std::array<std::string_view, 95> kGlyphs = {
    "", "0804 0202", "0806 2826", "1218 3238 0444 0646", "473818070615354443321203 2921",
    "0248 0818170708 3242433332", "4206071827260403122244", "0806", "19070311", "09171301", "2428 0547 0745",
    "2327 0545", "1201", "0535", "0202", "0138", "180703122233372818", "061812 0222", "07182837360232",
    "07182837362515 253433221203", "2228 280434", "3808052534332202", "3728180703122233342505", "083812",
    "180706152536372818 1504031222333425", "0312223337281807061535", "0303 0606", "1201 1616", "370533", "0434 0636",
    "073503", "07182837362524 2222", "321203071838474434362615142435", "022842 1434", "02083847463505 3544433202",
    "4738180703123243", "02082846442202", "42020848 0535", "020848 0535", "47381807031232434525", "0208 4248 0545",
    "0222 1218 0828", "3833221203", "0208 4804 1542", "080242", "0208254842", "02084248", "180703123243473818",
    "02083847463505", "180703123243473818 2442", "02083847463505 2542", "473818070615354443321203", "2228 0848",
    "080312324348", "082248", "0812263248", "0248 0842", "082548 2522", "08480242", "19090111", "0831", "09191101",
    "062846", "0141", "0817", "0516263532 341403122233", "0802 0312223335261605", "3526160503122233",
    "3832 3322120305162635", "04343526160503122233", "281712 0626", "3631201001 3322120305162635", "0802 0516263532",
    "0602 0808", "161100 1818", "0802 3603 1432", "080312", "0602 05162522 25364542", "0602 0516263532",
    "160503122233352616", "0600 0312223335261605", "3630 3322120305162635", "0602 051626", "35261605142433221203",
    "181322 0626", "0603122233 3632", "062246", "0612253246", "0236 0632", "0603122233 3631201001", "06360232",
    "29181605141221", "0901", "09181625141201", "04153445"};
// clang-format on
constexpr double kBaseline = 2.0;
constexpr double kCapital = 6.0;      // grid units above the baseline
constexpr double kHalfStroke = 0.43;  // grid units
constexpr double kSpace = 1.9;        // grid units between glyphs, and of a blank

std::string_view glyph_of(char c) {
  return c >= ' ' && c <= '~' ? kGlyphs[static_cast<std::size_t>(c - ' ')] : kGlyphs['?' - ' '];
}

double glyph_width(std::string_view glyph) {
  double width = 0.0;
  for (std::size_t i = 0; i + 1 < glyph.size(); i += 2) {
    if (glyph[i] == ' ') ++i;
    width = std::max(width, static_cast<double>(glyph[i] - '0'));
  }
  return width;
}

struct Point {
  double x, y;
};

double distance_to_segment(Point p, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double squared = dx * dx + dy * dy;
  const double t = squared > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/// Distance of a place on the grid to the nearest stroke.
double distance_to_glyph(std::string_view glyph, Point place) {
  double nearest = 1e9;
  for (std::size_t i = 0; i + 3 < glyph.size(); i += 2) {
    if (glyph[i] == ' ') ++i;
    if (glyph[i + 2] == ' ') continue;
    const auto at = [&](std::size_t k) { return Point{double(glyph[k] - '0'), double(glyph[k + 1] - '0')}; };
    nearest = std::min(nearest, distance_to_segment(place, at(i), at(i + 2)));
  }
  return nearest;
}

void draw_glyph(Image& image, std::string_view glyph, double left, double baseline, double unit, Pixel color) {
  const int x_begin = std::max(0, static_cast<int>(left - unit));
  const int x_end = std::min(image.width, static_cast<int>(left + 5.0 * unit) + 1);
  const int y_begin = std::max(0, static_cast<int>(baseline - 8.0 * unit));
  const int y_end = std::min(image.height, static_cast<int>(baseline + 3.0 * unit) + 1);
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = x_begin; x < x_end; ++x) {
      const Point place = {(x + 0.5 - left) / unit, (baseline - y - 0.5) / unit + kBaseline};
      const double cover = std::clamp((kHalfStroke - distance_to_glyph(glyph, place)) * unit + 0.5, 0.0, 1.0);
      if (cover == 0.0) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        std::uint8_t& channel = image.at(x, y)[c];
        channel = static_cast<std::uint8_t>((1.0 - cover) * channel + cover * color[c] + 0.5);
      }
    }
  }
}

}  // namespace

double text_width(std::string_view text, double size) {
  double width = 0.0;
  for (const char c : text) width += glyph_width(glyph_of(c)) + kSpace;
  return std::max(0.0, width - kSpace) * size / kCapital;
}

void draw_text(Image& image, std::string_view text, double left, double baseline, double size, Pixel color) {
  const double unit = size / kCapital;
  for (const char c : text) {
    const std::string_view glyph = glyph_of(c);
    draw_glyph(image, glyph, left, baseline, unit, color);
    left += (glyph_width(glyph) + kSpace) * unit;
  }
}

}  // namespace shapelight::drawing
