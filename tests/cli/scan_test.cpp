#include <gtest/gtest.h>

#include "cli/command.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

// shapelight scan: what it writes, says and refuses.
namespace shapelight::cli_test {
namespace {

using io::test::contains;
using io::test::slurp;

const std::string kMesh = data("meshes/fandisk.off");

Outcome scan(const Workplace& work, const std::string& output, const Arguments& more = {}) {
  Arguments arguments = {"scan", kMesh, "-o", work.path(output), "--width", "60", "--height", "50"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return work.run(arguments);
}

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

TEST(ScanCommand, WritesRangeImagesAndWhereTheyWereTaken) {
  const Workplace work;
  const Outcome done = scan(work, "out", {"--views", "3", "--random-pose", "--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(names_in(work.path("out")), (std::set<std::string>{"scan_00.ply", "scan_00.pose.txt", "scan_01.ply",
                                                               "scan_01.pose.txt", "scan_02.ply", "scan_02.pose.txt"}));
  EXPECT_EQ(work.files(), std::set<std::string>{"out"});
  const Geometry mesh = read_geometry(kMesh);
  const TriangleTree surface({mesh.positions, mesh.triangles});
  std::size_t points = 0;
  const auto report = done.json();
  for (const auto& view : report["result"]["views"]) {
    const Geometry image = read_geometry(work.path("out/" + view["scan"].get<std::string>()));
    const RigidTransform T_mesh_scan = read_transform(work.path("out/" + view["pose"].get<std::string>()));
    EXPECT_EQ(image.kind(), GeometryKind::RangeImage);
    EXPECT_EQ(image.grid->width, 60U);
    EXPECT_EQ(image.grid->height, 50U);
    EXPECT_TRUE(image.viewpoint);
    for (const Vec3& p : image.positions) ASSERT_LT(std::sqrt(surface.closest(T_mesh_scan * p).distance_sq), 1e-12);
    EXPECT_EQ(view["points"], image.size());
    EXPECT_EQ(view["T_mesh_scan"][1][3], T_mesh_scan(1, 3));
    points += image.size();
  }
  EXPECT_GT(points, 1500U);
  EXPECT_EQ(report["command"], "scan");
  EXPECT_EQ(report["counts"]["in"], mesh.size());
  EXPECT_EQ(report["counts"]["out"], points);
  EXPECT_EQ(report["options"]["views"], 3);
  EXPECT_EQ(report["options"]["random-pose"], true);
  for (const char* phase : {"read", "scan", "write"}) EXPECT_TRUE(report["seconds"].contains(phase)) << phase;
}

TEST(ScanCommand, OneViewIntoOneFile) {
  const Workplace work;
  const Outcome done = scan(work, "one.pcd", {"--azimuth", "40", "--elevation", "-10", "--fov", "20"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(work.files(), (std::set<std::string>{"one.pcd", "one.pose.txt"}));
  const Geometry image = read_geometry(work.path("one.pcd"));
  EXPECT_EQ(image.grid->width, 60U);
  const Vec3 eye =
      read_transform(work.path("one.pose.txt")).translation() - bounding_box(read_geometry(kMesh).positions).center();
  EXPECT_NEAR(std::atan2(eye.x(), eye.z()) * 180.0 / 3.14159265358979, 40.0, 1e-6);
  EXPECT_NEAR(std::asin(eye.y() / eye.norm()) * 180.0 / 3.14159265358979, -10.0, 1e-6);
}

TEST(ScanCommand, NoiseIsALengthOrAShareOfTheDiagonal) {
  const Workplace work;
  const double diagonal = bounding_box(read_geometry(kMesh).positions).diagonal();
  const auto noise = [&](const std::string& typed) {
    const Outcome done = scan(work, "o", {"--noise", typed, "--force", "--json", "-"});
    EXPECT_EQ(done.code, 0) << done.err;
    return done.json()["options"]["noise"].get<double>();
  };
  EXPECT_EQ(noise("0.25"), 0.25);
  EXPECT_NEAR(noise("0.05%"), 0.0005 * diagonal, 1e-12);
  EXPECT_EQ(noise("0"), 0.0);
  const std::string exact = slurp(work.path("o/scan_00.ply"));
  (void)noise("1%");
  EXPECT_NE(slurp(work.path("o/scan_00.ply")), exact);
}

TEST(ScanCommand, BytesAreTheSameForAnyThreadsAndTheirOwnForEverySeed) {
  const Workplace work;
  std::set<std::string> results;
  for (const char* threads : {"1", "2", "3", "8"}) {
    ASSERT_EQ(scan(work, "o", {"--noise", "1%", "--dropout", "0.1", "--threads", threads, "--force"}).code, 0);
    results.insert(slurp(work.path("o/scan_00.ply")));
  }
  EXPECT_EQ(results.size(), 1U);
  ASSERT_EQ(scan(work, "o", {"--noise", "1%", "--dropout", "0.1", "--seed", "1", "--force"}).code, 0);
  EXPECT_FALSE(results.contains(slurp(work.path("o/scan_00.ply"))));
}

TEST(ScanCommand, OverwritesOnlyWhenForced) {
  const Workplace work;
  ASSERT_EQ(scan(work, "o").code, 0);
  const std::string before = slurp(work.path("o/scan_00.ply"));
  const Outcome refused = scan(work, "o", {"--views", "2", "--azimuth", "90"});
  EXPECT_EQ(refused.code, 8);
  EXPECT_TRUE(contains(refused.err, "--force"));
  EXPECT_EQ(names_in(work.path("o")), (std::set<std::string>{"scan_00.ply", "scan_00.pose.txt"}));
  EXPECT_EQ(slurp(work.path("o/scan_00.ply")), before);
  ASSERT_EQ(scan(work, "o", {"--views", "2", "--azimuth", "90", "--force"}).code, 0);
  EXPECT_NE(slurp(work.path("o/scan_00.ply")), before);
  EXPECT_EQ(names_in(work.path("o")).size(), 4U) << "nothing else is left";
}

TEST(ScanCommand, DryRunWritesNothing) {
  const Workplace work;
  const Outcome done = scan(work, "o", {"--dry-run", "--json", "-"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_GT(done.json()["counts"]["out"].get<int>(), 100);
  EXPECT_TRUE(work.files().empty());
}

TEST(ScanCommand, BadUsageIsTwo) {
  const Workplace work;
  const std::vector<std::pair<Arguments, const char*>> cases = {
      {{"--views", "0"}, "--views: 0"},       {{"--elevation", "91"}, "--elevation: 91"},
      {{"--fov", "180"}, "--fov: 180"},       {{"--max-incidence", "2"}, "--max-incidence: 2"},
      {{"--noise", "-1"}, "--noise: -1"},     {{"--noise", "-1%"}, "--noise: '-1%'"},
      {{"--noise", "1mm"}, "--noise: '1mm'"}, {{"--dropout", "1.5"}, "--dropout: 1.5"}};
  for (const auto& [more, message] : cases) {
    const Outcome refused = scan(work, "o", more);
    EXPECT_EQ(refused.code, 2) << message;
    EXPECT_TRUE(contains(refused.err, message));
  }
  const Outcome two = scan(work, "o.ply", {"--views", "2"});
  EXPECT_EQ(two.code, 2);
  EXPECT_TRUE(contains(two.err, "expected a folder"));
  const Outcome cloud = work.run({"scan", data("clouds/simple.las"), "-o", work.path("o")});
  EXPECT_EQ(cloud.code, 2);
  EXPECT_TRUE(contains(cloud.err, "has no triangles"));
  EXPECT_TRUE(work.files().empty());
}

TEST(ScanCommand, WhatCannotBeWrittenLeavesNothing) {
  const Workplace work;
  EXPECT_EQ(scan(work, "no/such/folder").code, 8);
  work.write("file", "words");
  EXPECT_EQ(scan(work, "file").code, 8);
  EXPECT_EQ(slurp(work.path("file")), "words");
  EXPECT_EQ(work.files(), std::set<std::string>{"file"});
}

}  // namespace
}  // namespace shapelight::cli_test
