#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "io/scalar_bytes.hpp"
#include "point_files.hpp"

namespace shapelight {
namespace {

using test::expect_same;
using test::TempFolder;

std::string header(const std::string& fields, const std::string& sizes, const std::string& types,
                   const std::string& counts, int width, int height, const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " +
         types + "\nCOUNT " + counts + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) + "\nDATA " + data + "\n";
}

std::vector<std::uint8_t> bytes(const Geometry& g, const char* name) {
  return std::get<std::vector<std::uint8_t>>(g.attributes.find(name)->values);
}

// A 2 x 2 image with a pixel that saw nothing, colours, and a value of every type.
Geometry organised(ScalarType coordinates) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Geometry g;
  g.coordinate_type = coordinates;
  g.positions = {{0.5, -0.0, 1.0}, {nan, nan, nan}, {-0.1f, 3e-30f, 1e20f}, {1, 2, 3}};
  if (coordinates == ScalarType::Float64) g.positions[3] = {4320978.61, 0.1, 1e-300};
  g.grid = RangeGrid{2, 2, {0, 1, 2, 3}};
  g.attributes.set({"nx", std::vector<float>{1, 0, 0, -1}});
  g.attributes.set({"red", std::vector<std::uint8_t>{1, 2, 3, 255}});
  g.attributes.set({"green", std::vector<std::uint8_t>{4, 5, 6, 255}});
  g.attributes.set({"blue", std::vector<std::uint8_t>{7, 8, 9, 255}});
  g.attributes.set({"alpha", std::vector<std::uint8_t>{10, 11, 12, 255}});
  for (int t = 0; t < 10; ++t) {
    Column column = make_column(fmt::format("a{}", t), static_cast<ScalarType>(t), 4);
    std::visit(
        []<class T>(std::vector<T>& v) {
          v = {std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max(), std::numeric_limits<T>::min(), T{}};
        },
        column.values);
    g.attributes.set(std::move(column));
  }
  g.viewpoint = Vec3(0.1, 2.0, -3.0);
  g.comments = {"made by hand", " two  blanks", "", "viewpoint_quaternion 0 1 0 0"};
  return g;
}

TEST(Pcd, RoundTripKeepsEveryBit) {
  const TempFolder folder;
  for (const bool ascii : {false, true}) {
    for (const ScalarType type : {ScalarType::Float32, ScalarType::Float64}) {
      const Geometry g = organised(type);
      EXPECT_TRUE(write_geometry(folder.file("a.pcd"), g, {.ascii = ascii, .overwrite = true}).empty());
      expect_same(g, read_geometry(folder.file("a.pcd")));
    }
  }
}

TEST(Pcd, RealFilesRoundTrip) {
  const TempFolder folder;
  for (const char* name : {"clouds/room_scan1.pcd", "scans/table_scene_mug_640x480.pcd"}) {
    const Geometry g = read_geometry(test::data_file(name));
    (void)write_geometry(folder.file("a.pcd"), g, {.overwrite = true});
    expect_same(g, read_geometry(folder.file("a.pcd")));
  }
}

TEST(Pcd, OrganisedCloudIsRangeImage) {
  const Geometry g = read_geometry(test::data_file("scans/table_scene_mug_640x480.pcd"));
  EXPECT_EQ(g.kind(), GeometryKind::RangeImage);
  EXPECT_EQ(g.size(), 307200u);
  EXPECT_EQ(g.grid->width, 640u);
  EXPECT_EQ(g.grid->pixel[641], 641u);
  std::size_t num_finite = 0;
  for (const Vec3& p : g.positions) num_finite += p.allFinite() ? 1 : 0;
  EXPECT_EQ(num_finite, 209280u);
  EXPECT_FALSE(g.viewpoint.has_value());
  EXPECT_NE(g.attributes.find("alpha"), nullptr);
}

TEST(Pcd, ScanWithHolesIsWrittenOrganised) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  g.grid = RangeGrid{2, 2, {2, kNoIndex, 0, 1}};
  (void)write_geometry(folder.file("a.pcd"), g);
  const Geometry back = read_geometry(folder.file("a.pcd"));
  ASSERT_EQ(back.size(), 4u);
  EXPECT_EQ(back.positions[0], Vec3(3, 3, 3));
  EXPECT_TRUE(std::isnan(back.positions[1].x()));
  EXPECT_EQ(back.positions[3], Vec3(2, 2, 2));
  EXPECT_EQ(back.grid->height, 2u);
}

// A grid that leaves points out would lose them.
TEST(Pcd, ScanWithStrayPointsIsWrittenUnorganised) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{1, 1, 1}, {2, 2, 2}};
  g.grid = RangeGrid{1, 2, {1, kNoIndex}};
  (void)write_geometry(folder.file("a.pcd"), g);
  const Geometry back = read_geometry(folder.file("a.pcd"));
  EXPECT_EQ(back.positions, g.positions);
  EXPECT_FALSE(back.grid.has_value());
}

TEST(Pcd, PackedColorsOfEveryDeclaration) {
  const TempFolder folder;
  const float packed = std::bit_cast<float>(0x00102030u);
  const std::string text = header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, 1, "ascii");
  Geometry g = read_geometry(folder.file("f.pcd", text + "1 2 3 1.4803e-39\n"));
  EXPECT_EQ(bytes(g, "red"), std::vector<std::uint8_t>{0x10});
  std::string binary = header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, 1, "binary");
  for (const float v : {1.0f, 2.0f, 3.0f, packed}) io::append_bytes(binary, v);
  g = read_geometry(folder.file("b.pcd", binary));
  EXPECT_EQ(bytes(g, "blue"), std::vector<std::uint8_t>{0x30});
  EXPECT_EQ(g.attributes.find("alpha"), nullptr);
  const std::string words = header("x y z rgba", "4 4 4 4", "F F F U", "1 1 1 1", 1, 1, "ascii");
  g = read_geometry(folder.file("u.pcd", words + "1 2 3 4279246896\n"));  // 0xFF102030
  EXPECT_EQ(bytes(g, "green"), std::vector<std::uint8_t>{0x20});
  EXPECT_EQ(bytes(g, "alpha"), std::vector<std::uint8_t>{0xFF});
}

TEST(Pcd, FieldsOfSeveralValuesAndPadding) {
  const TempFolder folder;
  const std::string text = header("x _ y z d normal_y", "4 1 4 4 2 4", "F U F F I F", "1 3 1 1 2 1", 1, 1, "ascii");
  const Geometry g = read_geometry(folder.file("a.pcd", text + "1 9 9 9 2 3 -5 6 0.5\n"));
  EXPECT_EQ(g.positions[0], Vec3(1, 2, 3));
  ASSERT_EQ(g.attributes.columns().size(), 3u);
  EXPECT_EQ(g.attributes.find("d_0")->as_double(0), -5.0);
  EXPECT_EQ(g.attributes.find("d_1")->as_double(0), 6.0);
  EXPECT_EQ(g.attributes.find("ny")->as_double(0), 0.5);
}

// A stream made by hand: ten literal bytes, then a reference; field by field, as binary_compressed has it.
TEST(Pcd, CompressedBytes) {
  const TempFolder folder;
  std::string text = header("x y z", "1 1 1", "U U U", "1 1 1", 6, 1, "binary_compressed");
  const std::string stream = std::string(
      "\x09"
      "ABCDEFGHIJ"
      "\xC0\x09",
      13);  // 8 bytes, 10 back
  io::append_bytes(text, static_cast<std::uint32_t>(stream.size()));
  io::append_bytes(text, std::uint32_t{18});
  const Geometry g = read_geometry(folder.file("a.pcd", text + stream));
  EXPECT_EQ(g.positions[0], Vec3('A', 'G', 'C'));
  EXPECT_EQ(g.positions[5], Vec3('F', 'B', 'H'));
}

TEST(Pcd, OlderHeaders) {
  const TempFolder folder;
  const Geometry g = read_geometry(
      folder.file("a.pcd", "COLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n0 0 1\n\n0 1 0"));
  EXPECT_EQ(g.positions, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}}));
}

TEST(Pcd, RefusesWithThePlace) {
  const TempFolder folder;
  const auto xyz = [](int width, int height, const std::string& data) {
    return header("x y z", "4 4 4", "F F F", "1 1 1", width, height, data);
  };
  std::string bomb = xyz(30000, 30000, "binary_compressed");
  io::append_bytes(bomb, std::uint32_t{4});
  io::append_bytes(bomb, std::uint32_t{900000000u * 4u});
  std::string damaged = xyz(1, 1, "binary_compressed");
  io::append_bytes(damaged, std::uint32_t{3});
  io::append_bytes(damaged, std::uint32_t{12});
  const std::vector<std::array<std::string, 3>> cases = {
      {"short text", xyz(2, 1, "ascii") + "1.000 2.000 3\n", "the file ends, expected point 1 of 2"},
      {"short row", xyz(2, 1, "ascii") + "1 2 3.000\n1 2\n", "point 1: 2 values, expected 3"},
      {"word", xyz(1, 1, "ascii") + "1 two 3\n", "'two' is not a number"},
      {"short binary", xyz(2, 1, "binary") + std::string(23, 'a'), "2 points of 12 bytes expected, 23 bytes left"},
      {"bomb", bomb + "abcd", "compressed"},
      {"damaged stream", damaged + "\xFF\xFF\xFF", "the compressed data is damaged"},
      {"no sizes", xyz(1, 1, "binary_compressed") + "abc", "two sizes expected"},
      {"no y", header("x z", "4 4", "F F", "1 1", 1, 1, "ascii") + "1 2\n", "lack x, y or z"},
      {"half float", header("x y z", "4 4 2", "F F F", "1 1 1", 1, 1, "ascii") + "1 2 3\n", "unknown SIZE and TYPE"},
      {"two names", header("x y z a a", "4 4 4 4 4", "F F F F F", "1 1 1 1 1", 1, 1, "ascii"), "unique names"},
      {"count 0", header("x y z", "4 4 4", "F F F", "1 1 0", 1, 1, "ascii"), "COUNT of field 2 is 0"},
      {"huge", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 4000000000\nHEIGHT 4000000000\nDATA ascii\n1 2 3\n",
       "expected at most"},
      {"many", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 4000000000\nHEIGHT 1\nDATA ascii\n1 2 3\n",
       "4000000000 points of 3 values expected"},
      {"empty", xyz(0, 1, "ascii"), "0 points"},
      {"mismatch", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 3\nDATA ascii\n", "POINTS is 3"},
  };
  for (const auto& [name, text, expected] : cases) {
    const std::string message = test::refusal(folder.file("bad.pcd", text));
    EXPECT_NE(message.find(expected), std::string::npos) << name << ": " << message;
  }
}

TEST(Pcd, WriterReportsWhatItCannotHold) {
  const TempFolder folder;
  Geometry g;
  g.attributes.set({"nx", std::vector<float>{1, 0, 0}});
  g.attributes.set({"normal_x", std::vector<float>{1, 0, 0}});
  g.attributes.set({"X", std::vector<float>{1, 0, 0}});
  g.positions = {{1, 2, 3}, {1, 0, 0}, {0, 0, 0}};
  g.triangles = {{0, 1, 2}};
  EXPECT_EQ(write_geometry(folder.file("a.pcd"), g), (std::vector<std::string>{"normal_x", "X", "triangles"}));
  EXPECT_EQ(read_geometry(folder.file("a.pcd")).attributes.columns().size(), 1u);
}

}  // namespace
}  // namespace shapelight
