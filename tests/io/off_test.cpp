#include "io/file_support.hpp"

namespace shapelight::io::test {
namespace {

constexpr std::string_view kBody = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST(Off, ReadsTheCountsWhereverTheyAre) {
  for (const std::string header : {"OFF\n3 1 0\n", "OFF 3 1 0\n", "OFF3 1 0\n", "# c\n\n OFF # c\n# c\n3 1\n"}) {
    const Geometry mesh = read_text(read_off, header + std::string(kBody));
    EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << header;
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_TRUE(mesh.warnings.empty());
  }
}

TEST(Off, CutsPolygonsAndLeavesFaceColoursOut) {
  const Geometry mesh = read_text(read_off, "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\nmore\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.warnings.size(), 3u);
}

TEST(Off, ReadsColoursAsBytesOrReals) {
  const Geometry bytes = read_text(read_off, "COFF\n2 0 0\n0 0 0 255 0 7 128\n1 0 0 1 1 1 1\n");
  EXPECT_EQ(bytes.attributes.find("red")->type(), ScalarType::UInt8);
  EXPECT_EQ(column(bytes, "red"), (std::vector<double>{255, 1}));
  EXPECT_EQ(column(bytes, "alpha"), (std::vector<double>{128, 1}));
  const Geometry reals = read_text(read_off, "COFF\n2 0 0\n0 0 0 1.0 0 0\n1 0 0 1 1 1\n");
  EXPECT_EQ(reals.attributes.find("red")->type(), ScalarType::Float32);
  EXPECT_EQ(column(reals, "red"), (std::vector<double>{1, 1}));
  EXPECT_EQ(reals.attributes.find("alpha"), nullptr);
}

TEST(Off, ReadsNormalsColoursAndTexcoordsTogether) {
  const Geometry mesh = read_text(read_off, "STCNOFF\n1 0 0\n1 2 3 0 0 1 9 8 7 0.5 0.25\n");
  EXPECT_EQ(mesh.positions[0], Vec3(1, 2, 3));
  EXPECT_EQ(column(mesh, "nz"), (std::vector<double>{1}));
  EXPECT_EQ(column(mesh, "blue"), (std::vector<double>{7}));
  EXPECT_EQ(column(mesh, "t"), (std::vector<double>{0.25}));
}

TEST(Off, RefusesWithTheLine) {
  const auto error = [](const std::string& text) { return error_of(read_off, text); };
  EXPECT_TRUE(contains(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
                       "line 6: face has vertex index 3, expected 0 .. 2"));
  EXPECT_TRUE(contains(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "line 6: face has vertex index -1"));
  EXPECT_TRUE(contains(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1 1\n"), "line 6: a face with 2 corners"));
  EXPECT_TRUE(contains(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9999999999 0 1 2\n"), "line 6"));
  EXPECT_TRUE(
      contains(error("OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n"), "line 6: vertex 1 of a face is not finite"));
  EXPECT_TRUE(contains(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0       \n"), "expected 1 faces, found 0"));
  EXPECT_TRUE(contains(error("OFF\n3 1 0\n0 0 0\n"), "do not fit into the 6 bytes"));
  EXPECT_TRUE(contains(error("OFF\n1 0 0\n0 0 0 5\n"), "line 3: 1 numbers more"));
  EXPECT_TRUE(contains(error("COFF\n1 0 0\n0 0 0 5\n"), "line 3: 1 colour numbers, expected 3"));
  EXPECT_TRUE(contains(error("OFF\n-1 0 0\n"), "line 2"));
  EXPECT_TRUE(contains(error("OFF\n0 0 0\n"), "line 2"));
  EXPECT_TRUE(contains(error("OFF BINARY\n"), "binary"));
  EXPECT_TRUE(contains(error("3 1 0\n"), "line 1: '3', expected OFF"));
  EXPECT_TRUE(contains(error("4OFF\n"), "line 1"));
  EXPECT_TRUE(contains(error("# only\n"), "expected 'OFF'"));
}

TEST(Off, WritesWhatItReads) {
  Geometry mesh = square();
  EXPECT_EQ(read_text(read_off, write_bytes(write_off, mesh).bytes).positions, mesh.positions);
  for (const char* name : {"red", "green", "blue"}) mesh.attributes.set({name, std::vector<float>{0, 1, 0.1F, 0.5F}});
  for (const char* name : {"nx", "ny", "nz"}) mesh.attributes.set({name, std::vector<double>{0.1, 1, 0, 0}});
  mesh.attributes.set({"label", std::vector<std::int32_t>(4)});
  const Written written = write_bytes(write_off, mesh);
  EXPECT_EQ(written.dropped, (DroppedAttributes{"label"}));
  const Geometry again = read_text(read_off, written.bytes);
  EXPECT_EQ(again.positions, mesh.positions);
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(column(again, "nx"), (std::vector<double>{0.1, 1, 0, 0}));
  EXPECT_EQ(again.attributes.find("green")->values, mesh.attributes.find("green")->values);
}

TEST(Off, WritesRealColoursThatCannotBeTakenForBytes) {
  Geometry cloud;
  cloud.positions = {Vec3::Zero()};
  for (const char* name : {"red", "green", "blue"}) cloud.attributes.set({name, std::vector<float>{1}});
  EXPECT_EQ(write_bytes(write_off, cloud).bytes, "COFF\n1 0 0\n0 0 0 1.0 1.0 1.0 1.0\n");
  for (const char* name : {"red", "green", "blue"}) cloud.attributes.set({name, std::vector<std::uint8_t>{1}});
  EXPECT_EQ(write_bytes(write_off, cloud).bytes, "COFF\n1 0 0\n0 0 0 1 1 1 255\n");
}

}  // namespace
}  // namespace shapelight::io::test
