#include "shapelight/render/color_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace shapelight {
namespace {

double lightness(ColorMap map, double t) { return to_oklab(map_color(map, t))[0]; }

double difference(const Color& a, const Color& b) {
  const auto p = to_oklab(a), q = to_oklab(b);
  return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

TEST(Oklab, KnowsWhiteGreyAndTheWayBack) {
  const auto white = to_oklab({1, 1, 1});
  EXPECT_NEAR(white[0], 1.0, 1e-6);
  EXPECT_NEAR(std::hypot(white[1], white[2]), 0.0, 1e-6);
  EXPECT_NEAR(to_oklab({0, 0, 0})[0], 0.0, 1e-12);
  for (const Color c : {Color{0.1F, 0.5F, 0.9F}, Color{0.9F, 0.2F, 0.05F}, Color{0.3F, 0.3F, 0.3F}}) {
    const Color back = from_oklab(to_oklab(c));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], c[k], 1e-5);
  }
}

TEST(ColorMap, SequentialMapsRiseInLightness) {
  for (const ColorMap map : {ColorMap::Sequential, ColorMap::BlueYellow}) {
    for (int i = 1; i <= 500; ++i) EXPECT_GT(lightness(map, i / 500.0), lightness(map, (i - 1) / 500.0)) << i;
    EXPECT_LT(lightness(map, 0.0), 0.3);
    EXPECT_GT(lightness(map, 1.0), 0.88);
  }
}

TEST(ColorMap, EqualStepsLookEquallyLarge) {
  for (const ColorMap map : {ColorMap::Sequential, ColorMap::BlueYellow, ColorMap::Diverging}) {
    std::vector<double> steps;
    for (int i = 0; i < 32; ++i) steps.push_back(difference(map_color(map, i / 32.0), map_color(map, (i + 1) / 32.0)));
    const auto [low, high] = std::minmax_element(steps.begin(), steps.end());
    EXPECT_LT(*high, 1.6 * *low) << static_cast<int>(map);
  }
}

TEST(ColorMap, DivergingIsLightestInTheMiddleAndEquallyDarkAtTheEnds) {
  for (int i = 1; i <= 100; ++i) {
    EXPECT_LT(lightness(ColorMap::Diverging, 0.5 + i / 200.0), lightness(ColorMap::Diverging, 0.5 + (i - 1) / 200.0));
    EXPECT_LT(lightness(ColorMap::Diverging, 0.5 - i / 200.0), lightness(ColorMap::Diverging, 0.5 - (i - 1) / 200.0));
  }
  EXPECT_NEAR(lightness(ColorMap::Diverging, 0.0), lightness(ColorMap::Diverging, 1.0), 0.03);
  EXPECT_GT(lightness(ColorMap::Diverging, 0.5), 0.95);
  EXPECT_GT(map_color(ColorMap::Diverging, 0.0)[2], map_color(ColorMap::Diverging, 0.0)[0]);  // blue below
  EXPECT_GT(map_color(ColorMap::Diverging, 1.0)[0], map_color(ColorMap::Diverging, 1.0)[2]);  // orange above
}

TEST(ColorMap, ClampsAndMarksNan) {
  EXPECT_EQ(map_color(ColorMap::Sequential, -3.0), map_color(ColorMap::Sequential, 0.0));
  EXPECT_EQ(map_color(ColorMap::Sequential, 1e300), map_color(ColorMap::Sequential, 1.0));
  const Color grey = map_color(ColorMap::Sequential, std::nan(""));
  EXPECT_EQ(grey[0], grey[1]);
  EXPECT_EQ(grey[1], grey[2]);
}

TEST(DistinctColor, LabelsThatFollowEachOtherDiffer) {
  for (std::int64_t label = 0; label < 300; ++label) {
    for (std::int64_t ahead = 1; ahead <= 4; ++ahead) {
      EXPECT_GT(difference(distinct_color(label), distinct_color(label + ahead)), 0.08) << label << " + " << ahead;
    }
  }
  EXPECT_EQ(distinct_color(-1), distinct_color(-7));
  static_cast<void>(distinct_color(std::numeric_limits<std::int64_t>::max()));
}

TEST(ValueRange, LeavesOutOneHundredthAtEachEnd) {
  std::vector<double> values(1001);
  for (std::size_t i = 0; i < values.size(); ++i) values[(i * 8) % 1001] = static_cast<double>(i);
  values.push_back(std::nan(""));
  const ValueRange range = value_range(values);
  EXPECT_EQ(range.min, 10.0);
  EXPECT_EQ(range.max, 990.0);
}

TEST(ValueRange, IsNeverEmpty) {
  EXPECT_EQ(value_range({}).max, 1.0);
  const std::vector<double> constant(5, 3.0);
  EXPECT_EQ(value_range(constant).min, 2.5);
  std::vector<double> mask(1000, 0.0);
  mask[17] = 1.0;
  EXPECT_EQ(value_range(mask).max, 1.0);
}

}  // namespace
}  // namespace shapelight
