#include "shapelight/render/field_colors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

Geometry three_points() {
  Geometry geometry;
  geometry.positions = {{-1, 0, 5}, {0, 1, 5}, {1, 2, 5}};
  return geometry;
}

TEST(ColorByField, ReadsEightAndSixteenBitColors) {
  Geometry geometry = three_points();
  geometry.attributes.set({"red", std::vector<std::uint8_t>{255, 0, 51}});
  geometry.attributes.set({"green", std::vector<std::uint8_t>{0, 255, 51}});
  geometry.attributes.set({"blue", std::vector<std::uint8_t>{0, 0, 51}});
  const FieldColors bytes = color_by_field(geometry, "rgb");
  EXPECT_TRUE(bytes.legend.name.empty());
  EXPECT_EQ(bytes.colors[0], (Color{1, 0, 0}));
  EXPECT_NEAR(bytes.colors[2][1], 0.2F, 1e-6);
  for (const char* name : {"red", "green", "blue"}) {
    geometry.attributes.set({name, std::vector<std::uint16_t>{65535, 0, 13107}});
  }
  EXPECT_NEAR(color_by_field(geometry, "rgb").colors[2][0], 0.2F, 1e-6);
  for (const char* name : {"red", "green", "blue"})
    geometry.attributes.set({name, std::vector<float>{1.0F, 0.5F, 0.0F}});
  EXPECT_EQ(color_by_field(geometry, "rgb").colors[1][2], 0.5F);
}

TEST(ColorByField, ShapeIndexDivergesOverItsWholeRange) {
  Geometry geometry = three_points();
  geometry.attributes.set({"shape_index", std::vector<float>{0.0F, 0.5F, std::nanf("")}});
  const FieldColors field = color_by_field(geometry, "shape_index");
  EXPECT_EQ(field.legend.map, ColorMap::Diverging);
  EXPECT_EQ(field.legend.min, -1.0);
  EXPECT_EQ(field.legend.max, 1.0);
  EXPECT_EQ(field.colors[0], map_color(ColorMap::Diverging, 0.5));
  EXPECT_EQ(field.colors[2], map_color(ColorMap::Diverging, std::nan("")));
}

TEST(ColorByField, SignedFieldsAreSymmetricAndOthersSequential) {
  Geometry geometry = three_points();
  geometry.attributes.set({"mean_curvature", std::vector<double>{-4.0, 0.0, 1.0}});
  geometry.attributes.set({"intensity", std::vector<std::uint16_t>{7, 8, 9}});
  const Legend curvature = color_by_field(geometry, "mean_curvature").legend;
  EXPECT_EQ(curvature.map, ColorMap::Diverging);
  EXPECT_EQ(curvature.max, 4.0);
  const Legend intensity = color_by_field(geometry, "intensity").legend;
  EXPECT_EQ(intensity.map, ColorMap::Sequential);
  EXPECT_EQ(intensity.min, 7.0);
  EXPECT_EQ(color_by_field(geometry, "x").legend.map, ColorMap::Sequential);
  EXPECT_EQ(color_by_field(geometry, "z").legend.min, 4.5);
}

TEST(ColorByField, SegmentsAreCategorical) {
  Geometry geometry = three_points();
  geometry.attributes.set({"segment", std::vector<std::uint32_t>{4, 4, 9}});
  const FieldColors field = color_by_field(geometry, "segment");
  EXPECT_EQ(field.legend.map, ColorMap::Categorical);
  EXPECT_EQ(field.colors[0], field.colors[1]);
  EXPECT_EQ(field.colors[2], distinct_color(9));
}

TEST(ColorByField, ListsTheFieldsThereAre) {
  Geometry geometry = three_points();
  geometry.attributes.set({"intensity", std::vector<float>{1, 2, 3}});
  for (const char* missing : {"rgb", "normal", "curvature", ""}) {
    try {
      static_cast<void>(color_by_field(geometry, missing));
      FAIL() << missing;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("intensity"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace shapelight
