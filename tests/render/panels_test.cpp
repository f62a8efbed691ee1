#include "shapelight/render/panels.hpp"

#include <gtest/gtest.h>

#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

Geometry points() {
  Geometry geometry;
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 2}};
  return geometry;
}

TEST(MakePanels, EveryGeometryInEveryColourUnderEverySetOfDots) {
  const Geometry a = points(), b = points();
  const std::vector<NamedGeometry> inputs = {{&a, "a"}, {&b, "b"}};
  const std::vector<std::string> colors = {"none", "z"};
  const std::vector<NamedDots> dots = {{a.positions, "few"}, {b.positions, "many"}};
  const std::vector<RenderItem> panels = make_panels(inputs, colors, dots);
  std::vector<std::string> titles;
  for (const RenderItem& panel : panels) titles.push_back(panel.title);
  EXPECT_EQ(titles, (std::vector<std::string>{"a, few", "a, many", "a: z, few", "a: z, many", "b, few", "b, many",
                                              "b: z, few", "b: z, many"}));
  EXPECT_EQ(panels[7].geometry, &b);
  EXPECT_EQ(panels[7].colors.size(), 3U);
  EXPECT_EQ(panels[7].dots.size(), 3U);
}

TEST(MakePanels, WhatHasNoNameGetsNoSeparators) {
  const Geometry a = points();
  const std::vector<NamedGeometry> inputs = {{&a, ""}};
  const std::vector<std::string> colors = {"none", "z"};
  const std::vector<RenderItem> panels = make_panels(inputs, colors);
  ASSERT_EQ(panels.size(), 2U);
  EXPECT_EQ(panels[0].title, "");
  EXPECT_EQ(panels[1].title, "z");
}

TEST(MakePanels, SizesAreDiametersAndChecked) {
  const Geometry a = points();
  const std::vector<NamedGeometry> inputs = {{&a, ""}};
  const RenderItem panel = make_panels(inputs, {}, {}, {.point = 3.0, .dot = 5.0}).at(0);
  EXPECT_EQ(panel.point_radius, 1.5);
  EXPECT_EQ(panel.dot_radius, 2.5);
  EXPECT_THROW((void)make_panels(inputs, {}, {}, {.point = -1.0}), InvalidInput);
}

}  // namespace
}  // namespace shapelight
