#include <gtest/gtest.h>

#include "cli/command.hpp"
#include "shapelight/io/transform.hpp"

// shapelight align: what it writes, says and refuses.
namespace shapelight::cli_test {
namespace {

using io::test::contains;
using io::test::slurp;
using Names = std::set<std::string>;

Names names_in(const std::string& folder) {
  Names names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

// Four neighbouring views of twelve.
class AlignCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    views_ = new Workplace;
    const Outcome done = views_->run({"scan", data("meshes/bunny.ply"), "-o", views_->path("v"), "--views", "12",
                                      "--width", "140", "--height", "140", "--random-pose", "--noise", "0.05%", "-q"});
    ASSERT_EQ(done.code, 0) << done.err;
  }
  static void TearDownTestSuite() { delete views_; }

  static std::string view(int i) { return views_->path("v/scan_0" + std::to_string(i) + ".ply"); }
  static RigidTransform truth(int i) {
    return read_transform(views_->path("v/scan_0" + std::to_string(i) + ".pose.txt"));
  }

  Outcome align(const Arguments& scans, const Arguments& more = {}) const {
    Arguments arguments = {"align"};
    arguments.insert(arguments.end(), scans.begin(), scans.end());
    arguments.insert(arguments.end(), {"-o", work_.path("out"), "--ratio", "0.2"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return work_.run(arguments);
  }

  static inline Workplace* views_ = nullptr;
  Workplace work_;
};

TEST_F(AlignCommand, WritesPosesTheMergedCloudAndAReport) {
  const Outcome done = align({view(0), view(1), view(2)}, {"--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(names_in(work_.path("out")),
            (Names{"scan_00.pose.txt", "scan_01.pose.txt", "scan_02.pose.txt", "merged.ply", "report.json"}));
  EXPECT_EQ(work_.files(), Names{"out"});
  EXPECT_TRUE(contains(done.err, "3 of 3 scans placed")) << done.err;

  const auto report = done.json();
  EXPECT_EQ(report["schema"], "shapelight.report/1");
  EXPECT_EQ(report["command"], "align");
  EXPECT_EQ(report["input"].size(), 3u);
  EXPECT_EQ(report["options"]["min-confidence"], 0.5);
  EXPECT_EQ(report["options"]["method"], "ficp");
  EXPECT_EQ(report["result"]["placed"], 3);
  EXPECT_EQ(report["result"]["groups"], 1);
  EXPECT_GE(report["result"]["pairs"].size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const auto scan = report["result"]["scans"][i];
    EXPECT_EQ(scan["file"], view(i));
    EXPECT_EQ(scan["group"], 0);
    EXPECT_EQ(scan["placed"], true);
    EXPECT_GT(scan["residual"].get<double>(), 0.0);
    const RigidTransform pose = read_transform(work_.path("out/" + scan["pose"].get<std::string>()));
    EXPECT_EQ(scan["T_world_scan"][1][3], pose(1, 3));
    const RigidTransform off = (truth(0).inverse() * truth(i)).inverse() * pose;
    EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 0.006) << "a third of a degree";
  }
  const auto written = nlohmann::json::parse(slurp(work_.path("out/report.json")));
  EXPECT_EQ(written["result"], report["result"]);

  const Geometry merged = read_geometry(work_.path("out/merged.ply"));
  EXPECT_EQ(merged.size(), report["counts"]["in"].get<std::size_t>());
  EXPECT_EQ(merged.attributes.find("scan")->as_double(merged.size() - 1), 2.0);
}

TEST_F(AlignCommand, NothingIsWrittenWhenScansStayAlone) {
  const std::string stranger = data("meshes/fandisk.off");
  const Outcome refused = align({view(0), stranger, view(1)}, {"--json", work_.path("r.json")});
  EXPECT_EQ(refused.code, 6) << refused.err;
  EXPECT_TRUE(contains(refused.err, "2 of 3 scans")) << refused.err;
  EXPECT_EQ(work_.files(), Names{"r.json"}) << "the report says why";
  const auto report = nlohmann::json::parse(slurp(work_.path("r.json")));
  EXPECT_EQ(report["result"]["scans"][1]["placed"], false);
  EXPECT_EQ(report["result"]["pairs"][0]["use"], "low confidence");

  const Outcome partial = align({view(0), stranger, view(1)}, {"--allow-partial"});
  EXPECT_EQ(partial.code, 6);
  EXPECT_EQ(names_in(work_.path("out")), (Names{"scan_00.pose.txt", "scan_01.pose.txt", "merged.ply", "report.json"}));
}

TEST_F(AlignCommand, NamesAreToldApartAndNothingIsReplaced) {
  const Outcome done = align({view(0), view(1)}, {"--no-merged", "-q"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(names_in(work_.path("out")), (Names{"scan_00.pose.txt", "scan_01.pose.txt", "report.json"}));
  const Outcome again = align({view(0), view(1)}, {"--no-merged"});
  EXPECT_EQ(again.code, 8);
  EXPECT_TRUE(contains(again.err, "--force")) << again.err;
  std::filesystem::create_directory(work_.path("other"));
  const std::string twin = work_.path("other/scan_00.ply");
  std::filesystem::copy_file(view(1), twin);
  ASSERT_EQ(align({view(0), twin}, {"--force", "--merged-spacing", "2%"}).code, 0);
  EXPECT_TRUE(names_in(work_.path("out")).contains("scan_00_2.pose.txt"));
  const std::size_t thinned = read_geometry(work_.path("out/merged.ply")).size();
  EXPECT_GT(thinned, 500u);
  EXPECT_LT(thinned, 5000u);
}

TEST_F(AlignCommand, BytesAreTheSameForAnyThreads) {
  std::string expected;
  for (const char* threads : {"1", "2", "8"}) {
    ASSERT_EQ(align({view(0), view(1), view(2)}, {"--threads", threads, "--force", "-q"}).code, 0);
    const std::string bytes = slurp(work_.path("out/merged.ply")) + slurp(work_.path("out/scan_02.pose.txt"));
    if (expected.empty()) expected = bytes;
    EXPECT_TRUE(bytes == expected) << threads << " threads";
  }
}

TEST_F(AlignCommand, BadUsage) {
  EXPECT_EQ(align({view(0)}).code, 2);
  EXPECT_EQ(align({view(0), view(1)}, {"--min-confidence", "2"}).code, 2);
  EXPECT_EQ(align({view(0), view(1)}, {"--method", "magic"}).code, 2);
  EXPECT_EQ(align({view(0), view(1)}, {"--merged-spacing", "wide"}).code, 2);
  EXPECT_EQ(align({view(0), work_.path("absent.ply")}).code, 3);
  EXPECT_EQ(align({view(0), data("malformed/assimp_empty.ply")}).code, 4);
  EXPECT_EQ(work_.files(), Names{});
  const std::string file = work_.write("file", "not a folder");
  Arguments onto_file = {"align", view(0), view(1), "-o", file, "--ratio", "0.2"};
  EXPECT_EQ(work_.run(onto_file).code, 8);
  EXPECT_EQ(slurp(file), "not a folder");
}

}  // namespace
}  // namespace shapelight::cli_test
