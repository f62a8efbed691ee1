#include <cstring>

#include "io/file_support.hpp"

namespace shapelight::io::test {
namespace {

// A facet of three corners, its normal left 0.
std::string facet(std::array<float, 9> corners, std::uint16_t attributes = 0) {
  std::string bytes(50, '\0');
  std::memcpy(bytes.data() + 12, corners.data(), 36);
  std::memcpy(bytes.data() + 48, &attributes, 2);
  return bytes;
}

std::string binary(std::string header, std::uint32_t count, const std::string& facets) {
  header.resize(84);
  std::memcpy(header.data() + 80, &count, 4);
  return header + facets;
}

constexpr std::array<float, 9> kLower = {0, 0, 0, 1, 0, 0, 1, 1, 0};
constexpr std::array<float, 9> kUpper = {-0.0F, 0, 0, 1, 1, 0, 0, 1, 0};

TEST(Stl, WeldsEqualCornersInOrderOfAppearance) {
  const Geometry mesh = read_text(read_stl, binary("solid but binary", 2, facet(kLower) + facet(kUpper)));
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.coordinate_type, ScalarType::Float32);
  EXPECT_TRUE(mesh.warnings.empty());
}

TEST(Stl, WarnsOfAttributeBytes) {
  const Geometry mesh = read_text(read_stl, binary("", 2, facet(kLower, 31) + facet(kUpper)));
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_TRUE(contains(mesh.warnings[0], "1 facets"));
}

TEST(Stl, RefusesABinaryFileOfTheWrongSize) {
  const std::string whole = binary("", 2, facet(kLower) + facet(kUpper));
  EXPECT_TRUE(contains(error_of(read_stl, whole.substr(0, 183)), "184 bytes, the file has 183"));
  EXPECT_TRUE(contains(error_of(read_stl, whole + "x"), "184 bytes, the file has 185"));
  EXPECT_TRUE(contains(error_of(read_stl, binary("", 0xffffffff, "")), "214748364834 bytes"));
  EXPECT_TRUE(contains(error_of(read_stl, binary("", 0, "")), "no facet"));
  EXPECT_TRUE(contains(error_of(read_stl, "abc"), "3 bytes"));
  EXPECT_TRUE(contains(error_of(read_stl, ""), "empty"));
}

TEST(Stl, RefusesCornersThatAreNotFinite) {
  std::array<float, 9> corners = kLower;
  corners[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(contains(error_of(read_stl, binary("", 1, facet(corners))), "byte 108: corner 1 of facet 0"));
}

std::string ascii_facet(std::string_view corners) {
  return "facet normal 0 0 1\n outer loop\n" + std::string(corners) + " endloop\nendfacet\n";
}

TEST(Stl, ReadsAsciiWithSeveralSolidsAndCapitals) {
  const std::string facet = ascii_facet("vertex 0 0 0\nvertex 1 0 0\nVERTEX 0 0.1 0\n");
  const Geometry mesh = read_text(read_stl, "  solid a b\n" + facet + "endsolid\r\nSOLID\n" + facet + "EndSolid\n");
  EXPECT_EQ(mesh.size(), 3u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}}));
  EXPECT_EQ(mesh.coordinate_type, ScalarType::Float64);
}

TEST(Stl, RefusesMalformedAsciiWithTheLine) {
  const auto solid = [](const std::string& facets) { return "solid\n" + facets + "endsolid\n"; };
  EXPECT_TRUE(
      contains(error_of(read_stl, solid(ascii_facet("vertex 0 0 0\nvertex 1 0 0\n"))), "line 6: a facet with 2"));
  EXPECT_TRUE(
      contains(error_of(read_stl, solid(ascii_facet("vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 0 0\n"))),
               "line 7: a vertex, expected 3"));
  EXPECT_TRUE(contains(error_of(read_stl, solid(ascii_facet("vertex 0 0\n"))), "line 4: '' is not a number"));
  EXPECT_TRUE(contains(error_of(read_stl, solid(ascii_facet("vertex 0 0 inf\n"))), "line 4"));
  EXPECT_TRUE(contains(error_of(read_stl, solid("vertex 0 0 0\n")), "line 2"));
  EXPECT_TRUE(contains(error_of(read_stl, solid("polygon\n")), "line 2: 'polygon', expected solid"));
  EXPECT_TRUE(contains(error_of(read_stl, "solid\n" + ascii_facet("vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n")),
                       "expected 'endsolid'"));
  EXPECT_TRUE(contains(error_of(read_stl, "solid\nendsolid\n"), "no facet"));
}

TEST(Stl, WritesWhatItReads) {
  Geometry mesh = square();
  mesh.attributes.set({"quality", std::vector<float>(4)});
  const Written ascii = write_bytes(write_stl, mesh, {.ascii = true});
  const Geometry text = read_text(read_stl, ascii.bytes);
  EXPECT_EQ(text.positions, mesh.positions);
  EXPECT_EQ(text.triangles, mesh.triangles);
  EXPECT_EQ(ascii.dropped, (DroppedAttributes{"quality"}));

  const Written written = write_bytes(write_stl, mesh);
  EXPECT_EQ(written.bytes.size(), 84u + 2 * 50);
  const Geometry again = read_text(read_stl, written.bytes);
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.positions[2], mesh.positions[2].cast<float>().cast<double>());
}

TEST(Stl, WritesUnitNormalsAndZeroForSlivers) {
  Geometry mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 1}};
  const std::string text = write_bytes(write_stl, mesh, {.ascii = true}).bytes;
  EXPECT_TRUE(contains(text, "facet normal 0 0 1\n"));
  EXPECT_TRUE(contains(text, "facet normal 0 0 0\n"));
}

TEST(Stl, WritingNeedsTriangles) {
  Geometry cloud;
  cloud.positions = {Vec3::Zero()};
  EXPECT_THROW(write_bytes(write_stl, cloud), InvalidInput);
}

}  // namespace
}  // namespace shapelight::io::test
