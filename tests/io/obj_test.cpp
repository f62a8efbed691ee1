#include "io/file_support.hpp"

namespace shapelight::io::test {
namespace {

constexpr std::string_view kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

std::string with_triangle(std::string_view rest) { return std::string(kTriangle) + std::string(rest); }

TEST(Obj, ReadsVerticesInFileOrderAndFacesOfEveryForm) {
  const Geometry mesh = read_text(read_obj, with_triangle("vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n"
                                                          "f 1 2 3\nf 3/1 1/2 2/3\nf 1//1 2//1 3//1\n"
                                                          "f -3/-3/-1 -2/-2/-1 -1/-1/-1\n"));
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 0, 1}, {0, 1, 2}, {0, 1, 2}}));
  EXPECT_EQ(mesh.format, "obj");
  EXPECT_EQ(column(mesh, "nz"), (std::vector<double>{1, 1, 1}));
  EXPECT_TRUE(mesh.corner_texcoords.empty());  // two faces have none
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_TRUE(contains(mesh.warnings[0], "texture coordinates"));
}

TEST(Obj, CutsPolygonsIntoFansAndCountsThem) {
  const Geometry mesh = read_text(read_obj, "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\nf 1 2 3\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 1, 2}}));
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_TRUE(contains(mesh.warnings[0], "1 polygons"));
}

TEST(Obj, AcceptsContinuedLinesCrlfTabsAndComments) {
  const Geometry mesh = read_text(read_obj,
                                  "# made by hand\r\nv 0 0 \\\r\n 0\r\nv\t1 0 0 # second\r\nv 0 1 0\\\r\n\r\n"
                                  "f 1 \\\r\n2\\\r\n 3\r\n");
  EXPECT_EQ(mesh.size(), 3u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(mesh.comments, (std::vector<std::string>{"made by hand"}));
  EXPECT_TRUE(contains(error_of(read_obj, "v 1 \\ 2 3\n"), "line 1"));
}

TEST(Obj, ReadsCrLineEnds) { EXPECT_EQ(read_text(read_obj, "v 1 2 3\rv 4 5 6\r").size(), 2u); }

TEST(Obj, LeavesOtherStatementsOutWithOneWarning) {
  const Geometry mesh =
      read_text(read_obj, with_triangle("mtllib a.mtl\no name\ng a b\nusemtl m\ns off\nl 1 2 \\\n3\nf 1 2 3\n"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_TRUE(contains(mesh.warnings[0], "6 statements"));
  EXPECT_TRUE(contains(mesh.warnings[0], "usemtl"));
}

TEST(Obj, ReadsColoursWhenEveryVertexHasOne) {
  const Geometry mesh = read_text(read_obj, "v 0 0 0 1 0.5 0\nv 1 0 0 0 0.25 1\n");
  EXPECT_EQ(column(mesh, "green"), (std::vector<double>{0.5, 0.25}));
  EXPECT_EQ(mesh.attributes.find("red")->type(), ScalarType::Float32);
  const Geometry partial = read_text(read_obj, "v 0 0 0 1 0.5 0\nv 1 0 0\n");
  EXPECT_TRUE(partial.attributes.empty());
  EXPECT_EQ(partial.warnings.size(), 1u);
}

TEST(Obj, IgnoresTheWeight) {
  const Geometry mesh = read_text(read_obj, "v 1 2 3 0.5\n");
  EXPECT_EQ(mesh.positions[0], Vec3(1, 2, 3));
  EXPECT_TRUE(mesh.attributes.empty());
}

TEST(Obj, KeepsNormalsOnlyWhenEveryVertexHasExactlyOne) {
  const std::string normals = "vn 0 0 1\nvn 0 1 0\nvn 0 0 1\n";
  // Normals 1 and 3 have the same value, so vertex 1 still has exactly one.
  const Geometry same = read_text(read_obj, with_triangle(normals + "f 1//1 2//2 3//1\nf 1//3 2//2 3//3\n"));
  EXPECT_EQ(column(same, "ny"), (std::vector<double>{0, 1, 0}));
  const Geometry two = read_text(read_obj, with_triangle(normals + "f 1//1 2//2 3//1\nf 1//2 2//2 3//3\n"));
  EXPECT_EQ(two.attributes.find("nx"), nullptr);
  ASSERT_EQ(two.warnings.size(), 1u);
  EXPECT_TRUE(contains(two.warnings[0], "normals"));
  const Geometry missing = read_text(read_obj, with_triangle("vn 0 0 1\nvn 0 1 0\nf 1//1 2//2 3\n"));
  EXPECT_EQ(missing.attributes.find("nx"), nullptr);
}

TEST(Obj, GivesNormalsOfPointsWithoutFacesByNumber) {
  const Geometry cloud = read_text(read_obj, "vn 0 0 1\nv 0 0 0\nvn 0 1 0\nv 1 0 0\n");
  EXPECT_EQ(column(cloud, "nz"), (std::vector<double>{1, 0}));
}

TEST(Obj, KeepsTexcoordsOfCorners) {
  const Geometry mesh = read_text(read_obj, with_triangle("f 1/1 2/2 3/1\nvt 0.5 0.25\nvt 1 0\n"));
  EXPECT_EQ(mesh.corner_texcoords, (std::vector<std::array<float, 2>>{{0.5F, 0.25F}, {1, 0}, {0.5F, 0.25F}}));
}

TEST(Obj, ChoosesTheNarrowestCoordinateType) {
  EXPECT_EQ(read_text(read_obj, "v 0.5 1 2\n").coordinate_type, ScalarType::Float32);
  const Geometry utm = read_text(read_obj, "v 637012.24 849028.31 431.66\n");
  EXPECT_EQ(utm.coordinate_type, ScalarType::Float64);
  EXPECT_EQ(utm.positions[0], Vec3(637012.24, 849028.31, 431.66));
}

TEST(Obj, RefusesWithTheLine) {
  EXPECT_TRUE(
      contains(error_of(read_obj, with_triangle("f 1 2 4\n")), "line 4: face has vertex index 4, expected 1 .. 3"));
  EXPECT_TRUE(contains(error_of(read_obj, with_triangle("f 1 2 0\n")), "line 4: face has vertex index 0"));
  EXPECT_TRUE(contains(error_of(read_obj, with_triangle("f 1 2 -4\n")), "line 4: face has vertex index -4"));
  EXPECT_TRUE(contains(error_of(read_obj, with_triangle("f 1 2 99999999999\n")), "line 4"));
  EXPECT_TRUE(contains(error_of(read_obj, with_triangle("f 1 2 3x\n")), "line 4: '3x' is not an integer"));
  EXPECT_TRUE(contains(error_of(read_obj, with_triangle("f 1/1 2/1 3/1\n")), "texture index 1, expected 1 .. 0"));
  EXPECT_TRUE(contains(error_of(read_obj, with_triangle("f 1 2\n")), "a face with 2 corners, expected at least 3"));
  EXPECT_TRUE(contains(error_of(read_obj, "v 1 2\n"), "line 1: 2 numbers in 'v'"));
  EXPECT_TRUE(contains(error_of(read_obj, "v 1 2 a\n"), "'a' is not a number"));
  EXPECT_TRUE(contains(error_of(read_obj, "# nothing\n"), "without a vertex"));
  EXPECT_TRUE(contains(error_of(read_obj, ""), "empty"));
}

TEST(Obj, RefusesNonFiniteVerticesOfFacesOnly) {
  EXPECT_TRUE(contains(error_of(read_obj, "v 0 0 0\nv 1.#IND 0 0\nv 0 1 0\nf 1 2 3\n"), "line 2: vertex 2"));
  EXPECT_EQ(read_text(read_obj, with_triangle("v nan 0 0\nf 1 2 3\n")).size(), 4u);
}

TEST(Obj, WritesWhatItReads) {
  Geometry mesh = square();
  mesh.attributes.set({"nx", std::vector<float>{0, 0, 0, 0.1F}});
  mesh.attributes.set({"ny", std::vector<float>{0, 0, 1, 0}});
  mesh.attributes.set({"nz", std::vector<float>{1, 1, 0, 0}});
  mesh.attributes.set({"red", std::vector<std::uint8_t>{0, 51, 255, 1}});
  mesh.attributes.set({"green", std::vector<std::uint8_t>{0, 0, 0, 0}});
  mesh.attributes.set({"blue", std::vector<std::uint8_t>{0, 0, 0, 255}});
  mesh.attributes.set({"quality", std::vector<float>{1, 2, 3, 4}});
  mesh.corner_texcoords = {{0, 0}, {1, 0}, {1, 0.1F}, {0, 0}, {1, 0.1F}, {0, 1}};
  mesh.comments = {"a square"};
  const Written written = write_bytes(write_obj, mesh);
  EXPECT_EQ(written.dropped, (DroppedAttributes{"quality"}));
  const Geometry again = read_text(read_obj, written.bytes);
  EXPECT_EQ(again.positions, mesh.positions);
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.corner_texcoords, mesh.corner_texcoords);
  EXPECT_EQ(again.comments, mesh.comments);
  EXPECT_EQ(column(again, "ny"), (std::vector<double>{0, 0, 1, 0}));
  EXPECT_EQ(static_cast<float>(column(again, "nx")[3]), 0.1F);
  EXPECT_EQ(std::get<std::vector<float>>(again.attributes.find("red")->values)[1], 0.2F);
  EXPECT_TRUE(again.warnings.empty());
}

TEST(Obj, WritesFloatCoordinatesShort) {
  Geometry cloud;
  cloud.positions = {Vec3(static_cast<double>(0.1F), 2, 3)};
  cloud.coordinate_type = ScalarType::Float32;
  EXPECT_EQ(write_bytes(write_obj, cloud).bytes, "v 0.1 2 3\n");
  cloud.coordinate_type = ScalarType::Float64;
  EXPECT_EQ(write_bytes(write_obj, cloud).bytes, "v 0.10000000149011612 2 3\n");
}

}  // namespace
}  // namespace shapelight::io::test
