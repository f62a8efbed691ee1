#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "io/scalar_bytes.hpp"
#include "point_files.hpp"

namespace shapelight {
namespace {

using test::expect_same;
using test::TempFolder;

constexpr const char* kTriangleHeader = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
constexpr const char* kFourVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

Geometry read_ascii(const TempFolder& folder, const std::string& header, const std::string& body) {
  return read_geometry(folder.file("a.ply", "ply\nformat ascii 1.0\n" + header + "end_header\n" + body));
}

// One value of every type at its limits, NaN, a signed zero, texture coordinates, a grid with a hole.
Geometry rich_geometry(ScalarType coordinates) {
  Geometry g;
  g.coordinate_type = coordinates;
  g.positions = {{0.5, -0.0, 1.0}, {-0.1f, 3e-30f, 1e20f}, {0.0, 0.0, 0.0}};
  if (coordinates == ScalarType::Float64) g.positions[2] = {4320978.61, 0.1, 1e-300};
  for (int t = 0; t < 10; ++t) {
    Column column = make_column(fmt::format("a{}", t), static_cast<ScalarType>(t), 3);
    std::visit(
        []<class T>(std::vector<T>& v) {
          v = {std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max(), std::numeric_limits<T>::min()};
        },
        column.values);
    g.attributes.set(std::move(column));
  }
  g.triangles = {{0, 1, 2}, {2, 1, 0}};
  g.triangle_attributes.set({"material", std::vector<std::int16_t>{-7, 900}});
  g.corner_texcoords = {{0.1f, 0.2f}, {1.0f, 0.0f}, {0.0f, 1.0f}, {0.5f, 0.5f}, {0.25f, 1.0f}, {0.0f, 0.0f}};
  g.grid = RangeGrid{2, 2, {0, kNoIndex, 2, 1}};
  g.viewpoint = Vec3(1.0, 0.1, -3.0);
  g.comments = {"made by hand", "obj_info is_mesh 0", " two  blanks", ""};
  return g;
}

TEST(Ply, RoundTripKeepsEveryBit) {
  const TempFolder folder;
  for (const bool ascii : {false, true}) {
    for (const ScalarType type : {ScalarType::Float32, ScalarType::Float64}) {
      const Geometry g = rich_geometry(type);
      EXPECT_TRUE(write_geometry(folder.file("a.ply"), g, {.ascii = ascii, .overwrite = true}).empty());
      const Geometry back = read_geometry(folder.file("a.ply"));
      expect_same(g, back);
      EXPECT_TRUE(back.warnings.empty());
      EXPECT_EQ(back.format, "ply");
    }
  }
}

TEST(Ply, RoundTripKeepsNotANumber) {
  const TempFolder folder;
  Geometry g;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  g.positions = {{0, 0, 0}, {nan, inf, -inf}};
  for (const bool ascii : {false, true}) {
    (void)write_geometry(folder.file("a.ply"), g, {.ascii = ascii, .overwrite = true});
    expect_same(g, read_geometry(folder.file("a.ply")));
  }
}

TEST(Ply, RealFilesRoundTrip) {
  const TempFolder folder;
  for (const char* name : {"meshes/bunny.ply", "meshes/armadillo.ply", "scans/dragonStandRight_0.ply"}) {
    const Geometry g = read_geometry(test::data_file(name));
    for (const bool ascii : {false, true}) {
      (void)write_geometry(folder.file("a.ply"), g, {.ascii = ascii, .overwrite = true});
      expect_same(g, read_geometry(folder.file("a.ply")));
    }
  }
}

TEST(Ply, StanfordScanIsRangeImage) {
  const Geometry g = read_geometry(test::data_file("scans/dragonStandRight_0.ply"));
  EXPECT_EQ(g.kind(), GeometryKind::RangeImage);
  EXPECT_EQ(g.size(), 41841u);
  EXPECT_EQ(g.grid->width, 483u);
  EXPECT_EQ(g.grid->height, 262u);
  const auto& pixels = g.grid->pixel;
  EXPECT_EQ(pixels.size() - static_cast<std::size_t>(std::count(pixels.begin(), pixels.end(), kNoIndex)), g.size());
}

TEST(Ply, BunnyHasItsColumns) {
  const Geometry g = read_geometry(test::data_file("meshes/bunny.ply"));
  EXPECT_EQ(g.size(), 35947u);
  EXPECT_EQ(g.triangles.size(), 69451u);
  EXPECT_EQ(g.coordinate_type, ScalarType::Float32);
  EXPECT_EQ(g.positions[0], Vec3(-0.0378297f, 0.12794f, 0.00447467f));
  EXPECT_EQ(g.attributes.find("confidence")->as_double(0), static_cast<double>(0.850855f));
  EXPECT_EQ(g.triangles[0], (Triangle{21216, 21215, 20399}));
}

// Bytes put together by hand, so that reader and writer cannot share a mistake.
TEST(Ply, BigEndianBytes) {
  const TempFolder folder;
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\n"
      "property uchar red\nelement face 1\nproperty list ushort uint vertex_index\nend_header\n";
  for (int i = 0; i < 3; ++i) {
    text += std::string("\x3F\x80\0\0", 4);        // 1.0f
    text += std::string("\xC0\0\0\0\0\0\0\0", 8);  // -2.0
    text += std::string("\x01\x02", 2);            // 258
    text += static_cast<char>(200 + i);
  }
  text += std::string("\0\x03\0\0\0\x02\0\0\0\x01\0\0\0\0", 14);
  const Geometry g = read_geometry(folder.file("a.ply", text));
  EXPECT_EQ(g.positions[2], Vec3(1.0, -2.0, 258.0));
  EXPECT_EQ(g.coordinate_type, ScalarType::Float64);
  EXPECT_EQ(std::get<std::vector<std::uint8_t>>(g.attributes.find("red")->values),
            (std::vector<std::uint8_t>{200, 201, 202}));
  EXPECT_EQ(g.triangles, (std::vector<Triangle>{{2, 1, 0}}));
}

TEST(Ply, LoneReturnsInHeaderLeaveNewlineToBody) {
  const TempFolder folder;
  std::string text =
      "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty uchar x\rproperty uchar y\r"
      "property uchar z\rend_header\r";
  const Geometry g = read_geometry(folder.file("a.ply", text + "\n\x02\x03"));
  EXPECT_EQ(g.positions[0], Vec3(10.0, 2.0, 3.0));
}

TEST(Ply, PolygonsBecomeFans) {
  const TempFolder folder;
  const Geometry g =
      read_ascii(folder,
                 std::string(kTriangleHeader) +
                     "element face 3\nproperty list char short vertex_indices\nproperty uchar tag\n"
                     "property list uchar float texcoord\n",
                 std::string(kFourVertices) + "4 0 1 2 3 9 8 0 0 1 0 1 1 0 1\n2 0 1 7 0\n3 3 2 1 5 2 .5 .5\n");
  EXPECT_EQ(g.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {3, 2, 1}}));
  EXPECT_EQ(g.triangle_attributes.find("tag")->to_doubles(), (std::vector<double>{9, 9, 5}));
  ASSERT_EQ(g.corner_texcoords.size(), 9u);
  EXPECT_EQ(g.corner_texcoords[4], (std::array<float, 2>{1, 1}));
  EXPECT_EQ(g.corner_texcoords[5], (std::array<float, 2>{0, 1}));
  EXPECT_EQ(g.corner_texcoords[6], (std::array<float, 2>{0, 0}));
  EXPECT_EQ(g.warnings, (std::vector<std::string>{"1 faces with more than 3 corners cut into triangles",
                                                  "1 faces with fewer than 3 corners skipped",
                                                  "1 triangles without 2 texture coordinates per corner"}));
}

// Odd triangles of a strip are turned over; -1 starts anew; 2 2 only steers.
TEST(Ply, StripsUnroll) {
  const TempFolder folder;
  const Geometry g =
      read_ascii(folder, std::string(kTriangleHeader) + "element tristrips 2\nproperty list int int vertex_indices\n",
                 std::string(kFourVertices) + "8 0 1 2 3 -1 3 2 1\n4 0 1 2 2\n");
  EXPECT_EQ(g.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {3, 2, 1}, {0, 1, 2}}));
}

TEST(Ply, UnknownListsAreSteppedOver) {
  const TempFolder folder;
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement junk 2\nproperty list uchar short a\nproperty double b\n"
      "element vertex 1\nproperty uchar x\nproperty list uchar uchar more\nproperty uchar y\nproperty uchar "
      "z\nend_header\n";
  for (const int items : {2, 0}) {
    text += static_cast<char>(items);
    text += std::string(2 * items + 8, '\x7f');
  }
  text += "\x05\x02zz\x06\x07";
  const Geometry g = read_geometry(folder.file("a.ply", text));
  EXPECT_EQ(g.positions, (std::vector<Vec3>{{5, 6, 7}}));
  EXPECT_EQ(g.warnings,
            (std::vector<std::string>{"element junk with 2 rows skipped", "list more of element vertex skipped"}));
}

TEST(Ply, TextThatSaysMoreThanFloat32IsReadAsFloat64) {
  const TempFolder folder;
  const std::string header = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_EQ(read_ascii(folder, header, "-86.01312256 0.1 1e-7\n").coordinate_type, ScalarType::Float32);
  const Geometry utm = read_ascii(folder, header, "289814.15 4320978.61 170.76\n");
  EXPECT_EQ(utm.coordinate_type, ScalarType::Float64);
  EXPECT_EQ(utm.positions[0].y(), 4320978.61);
}

TEST(Ply, IntegerColumnsWiden) {
  const TempFolder folder;
  const std::string header = std::string(kTriangleHeader) + "property uchar a\nproperty int8 b\nproperty uint c\n";
  const Geometry g = read_ascii(folder, header, "0 0 0 255 -128 7.0\n0 0 0 -1 128 1\n0 0 0 1 40000 1\n0 0 0 1 1 1\n");
  EXPECT_EQ(g.attributes.find("a")->type(), ScalarType::Int16);
  EXPECT_EQ(g.attributes.find("b")->type(), ScalarType::Int32);
  EXPECT_EQ(g.attributes.find("c")->type(), ScalarType::UInt32);
  EXPECT_EQ(g.attributes.find("b")->to_doubles(), (std::vector<double>{-128, 128, 40000, 1}));
  EXPECT_EQ(g.warnings.size(), 2u);
}

TEST(Ply, WriterReportsWhatItCannotHold) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{1, 2, 3}};
  g.attributes.set({"x", std::vector<float>{1}});
  g.attributes.set({"two words", std::vector<float>{4}});
  g.attributes.set({"two\twords", std::vector<float>{5}});
  g.comments = {"two\nlines"};
  EXPECT_EQ(write_geometry(folder.file("a.ply"), g), (std::vector<std::string>{"x", "two\twords"}));
  const Geometry back = read_geometry(folder.file("a.ply"));
  EXPECT_EQ(back.attributes.find("two_words")->as_double(0), 4.0);
  EXPECT_EQ(back.comments, std::vector<std::string>{"two lines"});
}

TEST(Ply, CommentsAreNotTakenForGridOrViewpoint) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{1, 2, 3}};
  g.comments = {"obj_info num_cols none", "obj_info viewpoint unknown"};
  (void)write_geometry(folder.file("a.ply"), g);
  expect_same(g, read_geometry(folder.file("a.ply")));
}

struct BadPly {
  const char* name;
  std::string text;
  const char* message;  // part of it
};

TEST(Ply, RefusesWithThePlace) {
  const TempFolder folder;
  const std::string ascii = "ply\nformat ascii 1.0\n", binary = "ply\nformat binary_little_endian 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n", end = "end_header\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::vector<BadPly> cases = {
      {"huge count", binary + "element vertex 99999999999\n" + xyz + end + "abc",
       "99999999999 vertices, expected at most"},
      {"huge text count", ascii + "element vertex 4000000000\n" + xyz + end + "1 2 3\n", "4000000000 elements vertex"},
      {"beyond 64 bits", ascii + "element vertex 99999999999999999999\n" + xyz + end, "line 3"},
      {"negative", ascii + "element vertex -1\n" + xyz + end, "-1 elements"},
      {"short body", binary + "element vertex 2\n" + xyz + end + std::string(23, 'a'), "23 bytes left"},
      {"long list",
       binary + "element vertex 1\n" + xyz + face + end + std::string(12, '\0') + "\x03" + std::string(8, '\0'),
       "element face 0: property vertex_indices: 12 bytes expected, 8 left"},
      {"index too large", ascii + kTriangleHeader + face + end + kFourVertices + "3 0 1 4\n",
       "element face 0: vertex index 4, expected less than 4"},
      {"negative index", ascii + kTriangleHeader + face + end + kFourVertices + "3 0 1 -1\n", "vertex index -1"},
      {"very negative index", ascii + kTriangleHeader + face + end + kFourVertices + "3 0 1 -2\n",
       "-2 is no vertex index"},
      {"index in strip",
       ascii + kTriangleHeader + "element tristrips 1\nproperty list int int vertex_indices\n" + end + kFourVertices +
           "3 0 1 9\n",
       "tristrips 0: vertex index 9"},
      {"not a number", ascii + kTriangleHeader + end + "0 0 0\n0 zero 0\n0 0 0\n0 0 0\n",
       "line 9: 'zero' is not a number"},
      {"fraction in integer",
       ascii + kTriangleHeader + "property int n\n" + end + "0 0 0 1.5\n0 0 0 1\n0 0 0 1\n0 0 0 1\n",
       "line 9: '1.5' is not an integer"},
      {"short row within", ascii + kTriangleHeader + end + "0 0 0.00\n0 0\n0 0 0\n0 0 0\n",
       "element vertex 1: the row ends, expected z"},
      {"double property", ascii + "element vertex 1\n" + xyz + "property float x\n" + end + "0 0 0 0\n",
       "occurs twice"},
      {"double element", ascii + kTriangleHeader + kTriangleHeader + end, "occurs twice"},
      {"unknown type", ascii + "element vertex 1\nproperty quad x\n" + end, "line 4: unknown property type"},
      {"float count", ascii + kTriangleHeader + "element face 1\nproperty list float int vertex_indices\n" + end,
       "integer type"},
      {"no end", ascii + kTriangleHeader, "expected end_header"},
      {"grid size",
       ascii + "obj_info num_cols 2\nobj_info num_rows 2\n" + kTriangleHeader +
           "element range_grid 1\nproperty list uchar int vertex_indices\n" + end + kFourVertices + "0\n",
       "range_grid has 1 cells, expected obj_info num_cols x num_rows = 2 x 2"},
      {"grid cell of two",
       ascii + "obj_info num_cols 1\nobj_info num_rows 1\n" + kTriangleHeader +
           "element range_grid 1\nproperty list uchar int vertex_indices\n" + end + kFourVertices + "2 0 1\n",
       "range_grid 0: 2 vertex indices"},
      {"no finite point", ascii + "element vertex 1\n" + xyz + end + "nan nan nan\n", "none of them finite"},
  };
  for (const BadPly& bad : cases) {
    const std::string message = test::refusal(folder.file("bad.ply", bad.text));
    EXPECT_NE(message.find(bad.message), std::string::npos) << bad.name << ": " << message;
  }
}

TEST(Ply, StopRequestCancels) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW((void)read_geometry(test::data_file("meshes/bunny.ply"), {}, {.stop = stop.get_token()}), Cancelled);
}

}  // namespace
}  // namespace shapelight
