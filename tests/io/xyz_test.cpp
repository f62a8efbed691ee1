#include <limits>

#include "io/file_support.hpp"

namespace shapelight::io::test {
namespace {

std::vector<std::string> names(const Geometry& geometry) {
  std::vector<std::string> list;
  for (const Column& column : geometry.attributes.columns()) list.push_back(column.name);
  return list;
}

using Names = std::vector<std::string>;

TEST(Xyz, FindsTheSeparator) {
  for (const std::string row : {"1 2 3\n", "1\t2\t3\r\n", "1,2,3", "1; 2; 3\n", " 1 ,\t2 , 3 \n"}) {
    const Geometry cloud = read_text(read_xyz, "\n" + row);
    EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{1, 2, 3}})) << row;
    EXPECT_EQ(cloud.kind(), GeometryKind::Cloud);
  }
}

TEST(Xyz, GuessesColumnsFromTheirNumber) {
  EXPECT_EQ(names(read_text(read_xyz, "1 2 3 4\n")), (Names{"intensity"}));
  EXPECT_EQ(names(read_text(read_xyz, "1 2 3 4 5\n")), (Names{"scalar_3", "scalar_4"}));
  EXPECT_EQ(names(read_text(read_xyz, "1 2 3 0.6 0.8 0\n1 2 3 0 0 1.005\n")), (Names{"nx", "ny", "nz"}));
  EXPECT_EQ(names(read_text(read_xyz, "1 2 3 0.6 0.8 0\n1 2 3 0 0 1.02\n")), (Names{"red", "green", "blue"}));
  EXPECT_EQ(names(read_text(read_xyz, "1 2 3 0 0 0\n1 2 3 nan nan nan\n")), (Names{"red", "green", "blue"}));
  EXPECT_EQ(names(read_text(read_xyz, "1 2 3 4 5 6 7\n")), (Names{"intensity", "red", "green", "blue"}));
}

TEST(Xyz, ReadsNamesInAnyOrderAndCase) {
  const Geometry cloud = read_text(read_xyz, "\"Z\",\"Y\",X,Red,GREEN,b,GpsTime,myScalar\n3,2,1,10,20,30,0.1,5\n");
  EXPECT_EQ(cloud.positions[0], Vec3(1, 2, 3));
  EXPECT_EQ(names(cloud), (Names{"red", "green", "blue", "gps_time", "myScalar"}));
  EXPECT_EQ(cloud.attributes.find("blue")->type(), ScalarType::UInt8);
  EXPECT_EQ(cloud.attributes.find("gps_time")->type(), ScalarType::Float64);
  EXPECT_EQ(cloud.attributes.find("myScalar")->type(), ScalarType::Float32);
}

TEST(Xyz, ReadsNamesFromACommentThatFitsTheColumns) {
  EXPECT_EQ(names(read_text(read_xyz, "//X Y Z height\n1 2 3 4\n")), (Names{"height"}));
  const Geometry cloud = read_text(read_xyz, "# tuesday\n# where x y z is\n1 2 3 4\n# later\n1 2 3 4\n");
  EXPECT_EQ(names(cloud), (Names{"intensity"}));
  EXPECT_EQ(cloud.comments, (std::vector<std::string>{"tuesday"}));
}

TEST(Xyz, KeepsColoursBeyondBytes) {
  const Geometry cloud = read_text(read_xyz, "x y z red green blue\n0 0 0 1 2 65535\n");
  EXPECT_EQ(cloud.attributes.find("red")->type(), ScalarType::Float32);
  EXPECT_EQ(column(cloud, "blue"), (std::vector<double>{65535}));
}

TEST(Xyz, KeepsPointsThatAreNotFinite) {
  const Geometry cloud = read_text(read_xyz, "nan nan nan\n1 2 3\n-1.#IND 0 inf\n");
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_FALSE(cloud.positions[0].allFinite());
  EXPECT_FALSE(cloud.positions[2].allFinite());
}

TEST(Xyz, ChecksTheCountOfPts) {
  EXPECT_EQ(read_text(read_xyz, "2\n1 2 3 4 5 6 7\n1 2 3 4 5 6 7\n").size(), 2u);
  EXPECT_TRUE(contains(error_of(read_xyz, "3\n1 2 3\n1 2 3\n"), "line 3: the file ends after 2 points, expected 3"));
  EXPECT_TRUE(contains(error_of(read_xyz, "1\n1 2 3\n1 2 3\n"), "after 2 points, expected 1"));
}

TEST(Xyz, RefusesWithTheLine) {
  EXPECT_TRUE(contains(error_of(read_xyz, "1 2 3\n1 2\n"), "line 2: 2 columns, expected 3"));
  EXPECT_TRUE(contains(error_of(read_xyz, "1 2 3\n1 2 3 4\n"), "line 2: 4 columns, expected 3"));
  EXPECT_TRUE(contains(error_of(read_xyz, "1 2 3\n1 b 3\n"), "line 2: 'b' is not a number"));
  EXPECT_TRUE(contains(error_of(read_xyz, "1 b 3\n"), "line 1: 'b' is not a number"));
  EXPECT_TRUE(contains(error_of(read_xyz, "1 2\n"), "line 1: 2 columns"));
  EXPECT_TRUE(contains(error_of(read_xyz, "x y\n1 2\n"), "line 1: the columns' names lack"));
  EXPECT_TRUE(contains(error_of(read_xyz, "x,y,X\n1,2,3\n"), "line 1: column 'X' occurs twice"));
  EXPECT_TRUE(contains(error_of(read_xyz, "x y z\n1 2 3 4\n"), "line 2: 4 columns, expected the 3"));
  EXPECT_TRUE(contains(error_of(read_xyz, "x y z\n"), "without a point"));
  EXPECT_TRUE(contains(error_of(read_xyz, "x y z\na b c\n"), "line 2"));
  EXPECT_TRUE(contains(error_of(read_xyz, ""), "empty"));
  EXPECT_TRUE(contains(error_of(read_xyz, "1,,3\n1,2,3\n"), "line 1"));
}

TEST(Xyz, WritesWhatItReads) {
  Geometry cloud;
  cloud.positions = {{637012.24, 849028.31, 431.66}, {0.1, std::numeric_limits<double>::quiet_NaN(), 1e300}};
  cloud.attributes.set({"red", std::vector<std::uint8_t>{255, 0}});
  cloud.attributes.set({"scalar_weight", std::vector<double>{0.1, 1.0 / 3.0}});
  cloud.attributes.set({"label", std::vector<std::int32_t>{-5, 7}});
  cloud.attributes.set({"two words", std::vector<std::int32_t>{-5, 7}});
  const Written written = write_bytes(write_xyz, cloud);
  EXPECT_EQ(written.dropped, (DroppedAttributes{"two words"}));
  const Geometry again = read_text(read_xyz, written.bytes);
  EXPECT_EQ(names(again), (Names{"red", "scalar_weight", "label"}));
  EXPECT_EQ(again.positions[0], cloud.positions[0]);
  EXPECT_EQ(again.positions[1].z(), 1e300);
  EXPECT_TRUE(std::isnan(again.positions[1].y()));
  for (const std::string& name : names(again)) EXPECT_EQ(column(again, name), column(cloud, name)) << name;
  EXPECT_EQ(again.attributes.find("red")->type(), ScalarType::UInt8);
}

TEST(Xyz, WritesNoHeadingForBarePointsAndTellsOfTriangles) {
  const Written written = write_bytes(write_xyz, square());
  EXPECT_TRUE(written.bytes.starts_with("0.1 0 0\n"));
  EXPECT_EQ(written.dropped, (DroppedAttributes{"triangles"}));
}

}  // namespace
}  // namespace shapelight::io::test
