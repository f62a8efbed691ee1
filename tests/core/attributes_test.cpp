#include "shapelight/data/attributes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shapelight/data/geometry.hpp"

namespace shapelight {
namespace {

constexpr ScalarType kTypes[] = {ScalarType::Int8,   ScalarType::UInt8,  ScalarType::Int16,   ScalarType::UInt16, ScalarType::Int32,
                                 ScalarType::UInt32, ScalarType::Int64,  ScalarType::UInt64,  ScalarType::Float32, ScalarType::Float64};

TEST(Attributes, EveryTypeHasItsNameAndSize) {
  const char* const names[] = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"};
  const std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(scalar_type_name(kTypes[i]), names[i]);
    EXPECT_EQ(scalar_type_size(kTypes[i]), sizes[i]);
    const Column column = make_column("c", kTypes[i], 3);
    EXPECT_EQ(column.type(), kTypes[i]);
    EXPECT_EQ(column.to_doubles(), (std::vector<double>{0, 0, 0}));
  }
}

TEST(Attributes, GatherKeepsTypeBitsAndOrder) {
  const std::uint64_t large = std::numeric_limits<std::uint64_t>::max() - 1;
  const Column column{"id", std::vector<std::uint64_t>{1, large, 3}};
  const std::vector<Index> order = {2, 1, 1};
  const Column chosen = column.gather(order);
  EXPECT_EQ(chosen.name, "id");
  EXPECT_EQ(std::get<std::vector<std::uint64_t>>(chosen.values), (std::vector<std::uint64_t>{3, large, large}));
  EXPECT_EQ(column.gather({}).size(), 0u);
  EXPECT_EQ(column.gather({}).type(), ScalarType::UInt64);
}

TEST(Attributes, ANameOccursOnceAndKeepsItsPlace) {
  AttributeTable table;
  table.set(make_column("a", ScalarType::Int8, 2));
  table.set(make_column("b", ScalarType::Int8, 2));
  table.set({"a", std::vector<float>{1.5f, 2.5f}});
  ASSERT_EQ(table.columns().size(), 2u);
  EXPECT_EQ(table.columns()[0].name, "a");
  EXPECT_EQ(table.columns()[0].type(), ScalarType::Float32);
  EXPECT_EQ(table.find("a")->as_double(1), 2.5);
  EXPECT_EQ(table.find("c"), nullptr);
  EXPECT_TRUE(table.remove("a"));
  EXPECT_FALSE(table.remove("a"));
  EXPECT_EQ(table.columns().size(), 1u);
}

TEST(Geometry, SelectedPointsCarryWhatBelongsToPoints) {
  Geometry geometry;
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  geometry.coordinate_type = ScalarType::Float32;
  geometry.triangles = {{0, 1, 2}};
  geometry.attributes.set({"intensity", std::vector<std::uint16_t>{7, 8, 9}});
  geometry.comments = {"made by hand"};
  const std::vector<Index> kept = {2, 0};
  const Geometry chosen = select_points(geometry, kept);
  EXPECT_EQ(chosen.positions, (std::vector<Vec3>{{2, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(chosen.attributes.find("intensity")->to_doubles(), (std::vector<double>{9, 7}));
  EXPECT_EQ(chosen.coordinate_type, ScalarType::Float32);
  EXPECT_EQ(chosen.comments, geometry.comments);
  EXPECT_TRUE(chosen.triangles.empty());
}

TEST(Geometry, KindFollowsFromWhatThereIs) {
  Geometry geometry;
  EXPECT_EQ(geometry.kind(), GeometryKind::Cloud);
  geometry.grid = RangeGrid{};
  EXPECT_EQ(geometry.kind(), GeometryKind::RangeImage);
  geometry.triangles = {{0, 1, 2}};
  EXPECT_EQ(geometry.kind(), GeometryKind::Mesh);
}

TEST(Geometry, BoundsLeaveOutWhatIsNotFinite) {
  const std::vector<Vec3> points = {{HUGE_VAL, 0, 0}, {1, 2, 3}, {0, std::nan(""), 0}, {-1, 5, 0}};
  const BoundingBox box = bounding_box(points);
  EXPECT_EQ(box.min, Vec3(-1, 2, 0));
  EXPECT_EQ(box.max, Vec3(1, 5, 3));
  EXPECT_EQ(bounding_box({}).diagonal(), 0.0);
}

}  // namespace
}  // namespace shapelight
