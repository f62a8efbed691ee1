#include <gtest/gtest.h>

#include <fstream>

#include "cli/command.hpp"
#include "shapelight/io/transform.hpp"

// shapelight register: what it writes, says and refuses.
namespace shapelight::cli_test {
namespace {

using io::test::contains;

const std::string kSource = data("scans/dragonStandRight_24.ply");
const std::string kTarget = data("scans/dragonStandRight_0.ply");

double degrees_off(const RigidTransform& found) {
  const RigidTransform truth = read_transform(data("scans/T_dragonStandRight_24_to_0.txt"));
  return Eigen::AngleAxisd(found.linear().transpose() * truth.linear()).angle() * 180.0 / 3.14159265358979;
}

TEST(RegisterCommand, WritesTheMovedSourceTheTransformAndTheReport) {
  const Workplace work;
  const Outcome done = work.run({"register", kSource, kTarget, "-o", work.path("moved.ply"), "--transform",
                                 work.path("T.txt"), "--json", "-", "-q"});
  ASSERT_EQ(done.code, 0) << done.err;
  const RigidTransform T = read_transform(work.path("T.txt"));
  EXPECT_LT(degrees_off(T), 0.2);
  const nlohmann::json result = done.json()["result"];
  for (const char* key : {"T_target_source", "converged", "stop", "iterations", "inlier_ratio", "rms", "mean_error",
                          "std_error", "overlap", "confidence", "weakest_direction", "covariance"}) {
    EXPECT_TRUE(result.contains(key)) << key;
  }
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_NEAR(result["T_target_source"][row][column].get<double>(), T.matrix()(row, column), 1e-15);
    }
  }
  const Geometry moved = read_geometry(work.path("moved.ply"));
  const Geometry source = read_geometry(kSource);
  ASSERT_EQ(moved.size(), source.size());
  EXPECT_LT((moved.positions[1234] - T * source.positions[1234]).norm(), 1e-7);
}

TEST(RegisterCommand, StartsFromInitAndSearchesNothingThen) {
  const Workplace work;
  const Outcome done = work.run({"register", kSource, kTarget, "--init", data("scans/T_dragonStandRight_24_to_0.txt"),
                                 "--method", "gicp", "--json", "-", "-q"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.json()["result"]["hypotheses"], 0);
}

TEST(RegisterCommand, SharesAndLengthsMayBeGivenInPercent) {
  const Workplace work;
  const Outcome done =
      work.run({"register", kSource, kTarget, "--init", data("scans/T_dragonStandRight_24_to_0.txt"), "--method",
                "gicp", "--sampler", "random", "--ratio", "10%", "--max-distance", "5%", "--json", "-", "-q"});
  ASSERT_EQ(done.code, 0) << done.err;
  const nlohmann::json report = done.json();
  EXPECT_EQ(report["result"]["source_samples"], 3483) << "of 34,833 that are no strays";
  EXPECT_DOUBLE_EQ(report["options"]["ratio"].get<double>(), 0.1);
  EXPECT_DOUBLE_EQ(report["options"]["max-distance"].get<double>(),
                   0.05 * bounding_box(read_geometry(kTarget).positions).diagonal());
  EXPECT_EQ(work.run({"register", kSource, kTarget, "--ratio", "150%"}).code, 2);
}

TEST(RegisterCommand, AWrongPairIsRefusedAndNothingIsWritten) {
  const Workplace work;
  const Outcome refused = work.run({"register", data("meshes/fandisk.off"), kTarget, "-o", work.path("moved.ply"),
                                    "--transform", work.path("T.txt"), "--json", work.path("report.json")});
  EXPECT_EQ(refused.code, 6);
  EXPECT_TRUE(contains(refused.err, "confidence")) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(work.path("moved.ply")));
  EXPECT_FALSE(std::filesystem::exists(work.path("T.txt")));
  const nlohmann::json report = nlohmann::json::parse(io::test::slurp(work.path("report.json")));
  EXPECT_LT(report["result"]["confidence"].get<double>(), 0.5);
}

TEST(RegisterCommand, BadUsageIsToldBeforeAnythingIsRead) {
  const Workplace work;
  EXPECT_EQ(work.run({"register", "missing.ply", kTarget, "--min-confidence", "2"}).code, 2);
  EXPECT_EQ(work.run({"register", "missing.ply", kTarget, "--method", "magic"}).code, 2);
  EXPECT_EQ(work.run({"register", "missing.ply", kTarget}).code, 3);
  EXPECT_EQ(work.run({"register", kSource, kTarget, "--init", "missing.txt"}).code, 3);
  EXPECT_EQ(work.run({"register", kSource, kTarget, "--init", data("README.md")}).code, 4);
  EXPECT_EQ(work.run({"register", kSource}).code, 2);
}

TEST(RegisterCommand, TooFewPointsAreRefused) {
  const Workplace work;
  std::ofstream(work.path("three.xyz")) << "0 0 0\n1 0 0\n0 1 0\n";
  const Outcome refused = work.run({"register", work.path("three.xyz"), kTarget});
  EXPECT_EQ(refused.code, 4);
  EXPECT_TRUE(contains(refused.err, "source: 3 distinct finite points")) << refused.err;
}

}  // namespace
}  // namespace shapelight::cli_test
