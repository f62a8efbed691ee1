#include <cmath>

#include "cli/command.hpp"

namespace shapelight::cli_test {
namespace {

// A unit square at height z, of two triangles.
std::string square(double z) {
  std::string text = "OFF\n4 2 0\n";
  for (const char* xy : {"0 0 ", "1 0 ", "1 1 ", "0 1 "}) text += xy + std::to_string(z) + "\n";
  return text + "3 0 1 2\n3 0 2 3\n";
}

TEST(SurfaceMetrics, OfTwoMeshes) {
  const Workplace work;
  const std::string low = work.write("low.off", square(0.0)), high = work.write("high.off", square(0.5));
  const Outcome done = work.run({"metrics", low, high, "--json", "-", "--samples", "2000", "--seed", "3"});
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json report = done.json(), result = report["result"];
  EXPECT_EQ(report["options"]["samples"], 2000);
  EXPECT_EQ(report["options"]["seed"], 3);
  EXPECT_EQ(result["samples"], 2000);
  for (const char* direction : {"forward", "backward", "symmetric"}) {
    for (const char* key : {"mean", "rms", "max"}) {
      EXPECT_NEAR(result[direction][key].get<double>(), 0.5, 1e-12) << direction << key;
      EXPECT_NEAR(result["relative"][direction][key].get<double>(), 0.5 / std::sqrt(2.0), 1e-12) << direction << key;
    }
  }
  EXPECT_NEAR(result["rmse"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(result["vertex_rms"].get<double>(), 0.5, 1e-12);
  EXPECT_EQ(result["normal_deviation_deg"]["rms"], 0.0);
  EXPECT_EQ(result["normal_deviation_deg"]["p95"], 0.0);
  EXPECT_FALSE(result.contains("coverage_max"));
}

TEST(SurfaceMetrics, NormalsInDegrees) {
  const Workplace work;
  const std::string up = work.write("up.off", square(0.0));
  const std::string down = work.write("down.off", "OFF\n3 1 0\n0 0 0\n0 1 0\n1 0 0\n3 0 1 2\n");
  const Outcome done = work.run({"metrics", up, down, "--json", "-", "--samples", "100"});
  EXPECT_NEAR(done.json()["result"]["normal_deviation_deg"]["rms"].get<double>(), 180.0, 1e-4);
}

TEST(SurfaceMetrics, ForPeople) {
  const Workplace work;
  const std::string low = work.write("low.off", square(0.0)), high = work.write("high.off", square(0.5));
  const Outcome done = work.run({"metrics", low, high});
  EXPECT_NE(done.out.find("symmetric max           0.5           35.36 % of the diagonal"), std::string::npos) << done.out;
}

TEST(SurfaceMetrics, ARangeImageIsASurface) {
  const Workplace work;
  const std::string scan = data("scans/dragonStandRight_0.ply");
  const Outcome self = work.run({"metrics", scan, scan, "--json", "-", "--samples", "1000"});
  ASSERT_EQ(self.code, 0) << self.err;
  EXPECT_LT(self.json()["result"]["relative"]["symmetric"]["max"].get<double>(), 1e-12);
}

TEST(SurfaceMetrics, ACloudIsMeasuredByCoverage) {
  const Workplace work;
  const std::string mesh = work.write("mesh.off", square(0.0)), cloud = work.write("cloud.xyz", "0 0 0\n1 1 0\n");
  const Outcome done = work.run({"metrics", mesh, cloud, "--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.json()["result"]["coverage_max"], 1.0);
  EXPECT_FALSE(done.json()["result"].contains("forward"));
}

TEST(SurfaceMetrics, WritesTheDistanceOfEveryVertex) {
  const Workplace work;
  const std::string low = work.write("low.off", square(0.0));
  const std::string other = work.write("other.off", "OFF\n3 1 0\n0.5 0.5 2\n0.25 0.5 0\n1 4 4\n3 0 1 2\n");
  ASSERT_EQ(work.run({"metrics", low, other, "-o", work.path("out.ply")}).code, 0);
  const Geometry written = read_geometry(work.path("out.ply"));
  ASSERT_EQ(written.triangles.size(), 1U);
  const Column* distance = written.attributes.find("distance");
  ASSERT_NE(distance, nullptr);
  EXPECT_EQ(distance->as_double(0), 2.0);
  EXPECT_EQ(distance->as_double(1), 0.0);
  EXPECT_EQ(distance->as_double(2), 5.0);
  const std::string cloud = work.write("cloud.xyz", "0.5 0.5 7\n1 1 1\n");
  ASSERT_EQ(work.run({"metrics", low, cloud, "--distances", work.path("cloud.ply")}).code, 0);
  EXPECT_EQ(read_geometry(work.path("cloud.ply")).attributes.find("distance")->as_double(0), 7.0);
}

TEST(SurfaceMetrics, RefusesBeforeItMeasures) {
  const Workplace work;
  const std::string low = work.write("low.off", square(0.0)), cloud = work.write("cloud.xyz", "0 0 0\n1 1 0\n");
  EXPECT_EQ(work.run({"metrics", low, low, "-o", low}).code, 8) << "the input";
  EXPECT_EQ(work.run({"metrics", low, low, "-o", cloud}).code, 8) << "exists";
  EXPECT_EQ(work.run({"metrics", low, low, "--samples", "-1"}).code, 2);
  EXPECT_EQ(work.run({"metrics", low, low, "--samples", "many"}).code, 2);
  EXPECT_EQ(work.run({"metrics", cloud, low, "-o", work.path("out.ply")}).code, 2) << "no surface to measure to";
  const std::string line = work.write("line.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
  const Outcome flat = work.run({"metrics", low, line});
  EXPECT_EQ(flat.code, 2);
  EXPECT_NE(flat.err.find("test: the area is 0"), std::string::npos) << flat.err;
}

}  // namespace
}  // namespace shapelight::cli_test
