#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "cli/command.hpp"

// shapelight simplify: what it writes, says and refuses.
namespace shapelight::cli_test {
namespace {

using io::test::contains;
using io::test::slurp;

const std::string kMesh = data("meshes/fandisk.off");

Outcome simplify(const Workplace& work, const std::string& input, const std::string& output, const Arguments& more) {
  Arguments arguments = {"simplify", input, "-o", work.path(output)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return work.run(arguments);
}

// A wavy sheet as OBJ with texture coordinates in two charts, normals and colours.
std::string textured_obj() {
  constexpr int kSide = 20;
  std::ostringstream text;
  const auto id = [](int row, int column) { return row * kSide + column + 1; };
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      text << "v " << column << ' ' << row << ' ' << std::sin(0.4 * column) << " 0.5 " << 0.05 * row << " 0.25\n";
    }
  }
  for (int chart = 0; chart < 2; ++chart) {
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) text << "vt " << 10 * chart + 0.05 * column << ' ' << 0.05 * row << '\n';
    }
  }
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) text << "vn " << -0.4 * std::cos(0.4 * column) << " 0 1\n";
  }
  for (int row = 0; row + 1 < kSide; ++row) {
    for (int column = 0; column + 1 < kSide; ++column) {
      const int shift = column < kSide / 2 ? 0 : kSide * kSide;
      const auto corner = [&](int r, int c) {
        text << ' ' << id(r, c) << '/' << id(r, c) + shift << '/' << id(r, c);
      };
      for (const bool upper : {false, true}) {
        text << 'f';
        corner(row, column);
        if (upper) corner(row + 1, column + 1), corner(row + 1, column);
        else corner(row, column + 1), corner(row + 1, column + 1);
        text << '\n';
      }
    }
  }
  return text.str();
}

TEST(SimplifyCommand, CountsAreExactAndSourcesTrue) {
  const Workplace work;
  const Geometry before = read_geometry(kMesh);
  const Outcome done = simplify(work, kMesh, "o.ply", {"--vertices", "600", "--index-field"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.out, "") << "words belong on stderr";
  const Geometry after = read_geometry(work.path("o.ply"));
  EXPECT_EQ(after.size(), 600u);
  EXPECT_EQ(after.triangles.size(), 1196u) << "closed: twice the vertices less four";
  for (std::size_t v = 0; v < after.size(); ++v) {
    const auto source = static_cast<std::size_t>(after.attributes.find("source_index")->as_double(v));
    ASSERT_EQ(after.positions[v], before.positions.at(source));
  }
  ASSERT_EQ(simplify(work, kMesh, "p.ply", {"--ratio", "10%"}).code, 0);
  EXPECT_EQ(read_geometry(work.path("p.ply")).size(), 648u);  // of 6475
  ASSERT_EQ(simplify(work, kMesh, "q.ply", {"--faces", "1k"}).code, 0);
  EXPECT_NEAR(static_cast<double>(read_geometry(work.path("q.ply")).triangles.size()), 1000.0, 1.0);
}

TEST(SimplifyCommand, EveryMethodPlacementAndPreset) {
  const Workplace work;
  std::set<std::string> results;
  for (const Arguments& more :
       {Arguments{"--method", "ssim"}, Arguments{"--method", "ssim-paper"}, Arguments{"--method", "qslim"},
        Arguments{"--method", "qslim", "--placement", "optimal"}, Arguments{"--placement", "optimal"},
        Arguments{"--preset", "fast"}, Arguments{"--preset", "best"},
        Arguments{"--preset", "fast", "--placement", "optimal"}, Arguments{"--preset", "best", "--placement", "optimal"}}) {
    Arguments arguments = {"--vertices", "500", "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome done = simplify(work, kMesh, "o.ply", arguments);
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(read_geometry(work.path("o.ply")).size(), 500u);
    results.insert(slurp(work.path("o.ply")));
  }
  EXPECT_GE(results.size(), 8u) << "they differ";
  // The paper's method is the paper's preset, unless another one is named.
  const auto preset = [&](const Arguments& more) {
    Arguments arguments = {"--vertices", "500", "--force", "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return simplify(work, kMesh, "o.ply", arguments).json()["options"]["preset"].get<std::string>();
  };
  EXPECT_EQ(preset({}), "detail");
  EXPECT_EQ(preset({"--method", "ssim-paper"}), "paper");
  EXPECT_EQ(preset({"--method", "ssim-paper", "--preset", "detail"}), "detail");
}

TEST(SimplifyCommand, ReadsAndWritesEveryMeshFormat) {
  const Workplace work;
  for (const char* from : {"a.ply", "a.obj", "a.off", "a.stl"}) {
    ASSERT_EQ(work.run({"convert", kMesh, work.path(from)}).code, 0);
    for (const char* to : {"o.ply", "o.obj", "o.off", "o.stl"}) {
      const Outcome done = simplify(work, work.path(from), to, {"--vertices", "400", "--force", "-q"});
      ASSERT_EQ(done.code, 0) << from << " " << to << done.err;
      const Geometry written = read_geometry(work.path(to));
      EXPECT_EQ(written.size(), 400u);
      EXPECT_EQ(written.triangles.size(), 796u);
    }
  }
}

TEST(SimplifyCommand, TextureNormalsAndColoursTravelThroughObj) {
  const Workplace work;
  const std::string input = work.write("sheet.obj", textured_obj());
  const Geometry before = read_geometry(input);
  ASSERT_FALSE(before.corner_texcoords.empty());
  for (const char* placement : {"input", "optimal"}) {
    const Outcome done = simplify(work, input, "o.obj", {"--vertices", "120", "--placement", placement, "--force"});
    ASSERT_EQ(done.code, 0) << done.err;
    const Geometry after = read_geometry(work.path("o.obj"));
    EXPECT_EQ(after.size(), 120u);
    ASSERT_EQ(after.corner_texcoords.size(), 3 * after.triangles.size());
    EXPECT_NE(after.attributes.find("nx"), nullptr);
    EXPECT_NE(after.attributes.find("green"), nullptr);
    for (std::size_t c = 0; c < after.corner_texcoords.size(); ++c) {
      const auto [u, v] = after.corner_texcoords[c];
      const Vec3& p = after.positions[after.triangles[c / 3][c % 3]];
      EXPECT_EQ(u < 5.0F, after.corner_texcoords[3 * (c / 3)][0] < 5.0F) << "a face in two charts";
      EXPECT_NEAR(u - (u < 5.0F ? 0.0 : 10.0), 0.05 * p.x(), 0.03);
      EXPECT_NEAR(v, 0.05 * p.y(), 0.03);
    }
  }
}

TEST(SimplifyCommand, AttributesTravelUnlessDropped) {
  const Workplace work;
  const std::string bunny = data("meshes/bunny.ply");  // with confidence and intensity
  const auto names = [&](const Arguments& more) {
    Arguments arguments = {"--vertices", "500", "--method", "qslim", "--force", "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome done = simplify(work, bunny, "o.ply", arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_TRUE(contains(done.err, "1113 vertices in no face"));
    std::set<std::string> found;
    const Geometry written = read_geometry(work.path("o.ply"));
    for (const Column& column : written.attributes.columns()) found.insert(column.name);
    EXPECT_EQ(done.json()["attributes"]["kept"].get<std::set<std::string>>(), found);
    return found;
  };
  using Names = std::set<std::string>;
  EXPECT_EQ(names({}), (Names{"confidence", "intensity"}));
  EXPECT_EQ(names({"--drop", "confidence"}), Names{"intensity"});
  EXPECT_EQ(names({"--keep", "confidence", "--index-field"}), (Names{"confidence", "source_index"}));
}

TEST(SimplifyCommand, RangeImagesBecomeMeshesAndCloudsStayClouds) {
  const Workplace work;
  const Outcome image = simplify(work, data("scans/bun000_quarter.rif"), "i.ply", {"--ratio", "20%"});
  ASSERT_EQ(image.code, 0) << image.err;
  EXPECT_EQ(read_geometry(work.path("i.ply")).kind(), GeometryKind::Mesh);
  EXPECT_EQ(read_geometry(work.path("i.ply")).size(), 505u);  // of 2524

  const Outcome cloud = simplify(work, data("clouds/simple.las"), "c.las", {"--ratio", "0.1", "--json", "-"});
  ASSERT_EQ(cloud.code, 0) << cloud.err;
  EXPECT_EQ(read_geometry(work.path("c.las")).size(), 107u);
  EXPECT_TRUE(contains(cloud.err, "its points were sampled"));
  EXPECT_EQ(cloud.json()["result"]["sampled"], true);
  EXPECT_EQ(cloud.json()["result"]["kind"], "cloud");
  for (const Arguments& more : {Arguments{"--faces", "50"}, Arguments{"--max-error", "1%"},
                                Arguments{"--ratio", "0.1", "--placement", "optimal"},
                                Arguments{"--ratio", "0.1", "--method", "qslim"}, Arguments{"--ratio", "0.1", "--measure"}}) {
    const Outcome refused = simplify(work, data("clouds/simple.las"), "x.ply", more);
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(contains(refused.err, "point cloud")) << refused.err;
  }
  EXPECT_EQ(work.files(), (std::set<std::string>{"i.ply", "c.las"}));
}

TEST(SimplifyCommand, MaxErrorIsKeptAndReported) {
  const Workplace work;
  const double diagonal = bounding_box(testing::read_data("meshes/fandisk.off").positions).diagonal();
  const Outcome done = simplify(work, kMesh, "o.ply", {"--max-error", "0.5%", "--preset", "fast", "--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto result = done.json()["result"];
  EXPECT_LE(result["measured_max_error"].get<double>(), 0.005 * diagonal);
  EXPECT_GT(result["measured_max_error"].get<double>(), 0.001 * diagonal) << "no finer than needed";
  EXPECT_LE(result["relative"]["measured_max_error"].get<double>(), 0.005);
  EXPECT_LE(result["runs"].get<int>(), 9);
  EXPECT_TRUE(contains(done.err, "measured both ways"));
  EXPECT_NEAR(done.json()["options"]["max-error"].get<double>(), 0.005 * diagonal, 1e-12);
  // `metrics` measures the same distance.
  const Outcome measured = work.run({"metrics", kMesh, work.path("o.ply"), "--json", "-"});
  EXPECT_EQ(measured.code, 0);
}

TEST(SimplifyCommand, ReportHasTheKeysOfTheInterface) {
  const Workplace work;
  const Outcome done = simplify(work, kMesh, "o.ply", {"--ratio", "0.1", "--measure", "--placement", "optimal", "--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto report = done.json();
  EXPECT_EQ(report["schema"], "shapelight.report/1");
  EXPECT_EQ(report["command"], "simplify");
  EXPECT_EQ(report["input"]["faces"], 12946);
  EXPECT_EQ(report["options"]["method"], "ssim");
  EXPECT_EQ(report["options"]["placement"], "optimal");
  EXPECT_EQ(report["options"]["ratio"], 0.1);
  EXPECT_EQ(report["options"]["sample-weight"], 1.5);
  EXPECT_EQ(report["counts"]["in"], 6475);
  EXPECT_EQ(report["counts"]["out"], 648);
  EXPECT_EQ(report["result"]["vertices"], 648);
  EXPECT_EQ(report["result"]["faces"], 1292);
  EXPECT_EQ(report["result"]["faces_in"], 12946);
  EXPECT_EQ(report["result"]["method"], "ssim");
  EXPECT_EQ(report["result"]["sampled"], false);
  EXPECT_GT(report["result"]["measured_max_error"].get<double>(), report["result"]["measured_rms_error"].get<double>());
  EXPECT_TRUE(report["result"]["normal_deviation_deg"]["rms"].is_number());
  for (const char* phase : {"read", "simplify", "write"}) EXPECT_TRUE(report["seconds"].contains(phase)) << phase;
}

TEST(SimplifyCommand, BytesAreTheSameForAnyThreads) {
  for (const char* placement : {"input", "optimal"}) {
    const Workplace work;
    std::string expected;
    for (const char* threads : {"1", "2", "3", "8"}) {
      const Outcome done = simplify(work, kMesh, "o.ply", {"--ratio", "10%", "--placement", placement, "--threads", threads, "--force"});
      ASSERT_EQ(done.code, 0) << done.err;
      const std::string bytes = slurp(work.path("o.ply"));
      if (expected.empty()) expected = bytes;
      EXPECT_TRUE(bytes == expected) << threads << " threads";
    }
  }
}

TEST(SimplifyCommand, BadUsageIsTwo) {
  const Workplace work;
  const std::vector<std::pair<Arguments, const char*>> cases = {
      {{}, "exactly one of --vertices, --faces, --ratio and --max-error"},
      {{"--ratio", "0.1", "--faces", "5"}, "exactly one of"},
      {{"--ratio", "0"}, "--ratio: '0'"},
      {{"--ratio", "1.2"}, "--ratio: '1.2'"},
      {{"--vertices", "0"}, "--vertices: '0'"},
      {{"--faces", "1.5"}, "--faces: '1.5'"},
      {{"--max-error", "0"}, "--max-error: '0'"},
      {{"--max-error", "1mm"}, "--max-error: '1mm'"},
      {{"--ratio", "0.1", "--method", "magic"}, "ssim|ssim-paper|qslim"},
      {{"--ratio", "0.1", "--placement", "magic"}, "input|optimal"},
      {{"--ratio", "0.1", "--preset", "magic"}, "detail|fast|best|paper"},
      {{"--ratio", "0.1", "--preset", "paper", "--placement", "optimal"}, "--placement optimal"},
      {{"--ratio", "0.1", "--method", "ssim-paper", "--placement", "optimal"}, "--placement optimal"},
      {{"--ratio", "0.1", "--sample-weight", "0.5"}, "--sample-weight"},
      {{"--ratio", "0.1", "--sweeps", "1.5"}, "--sweeps"},
      {{"--ratio", "0.1", "--keep", "colour"}, "--keep: no attribute 'colour'"}};
  for (const auto& [options, message] : cases) {
    const Outcome refused = simplify(work, kMesh, "o.ply", options);
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_TRUE(contains(refused.err, message)) << refused.err;
    EXPECT_TRUE(work.files().empty());
  }
}

TEST(SimplifyCommand, MalformedInputIsFour) {
  const Workplace work;
  const std::string beyond = work.write("beyond.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  const std::string nan = work.write("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n");
  for (const std::string& input : {beyond, nan}) {
    const Outcome refused = simplify(work, input, "o.ply", {"--ratio", "0.5"});
    EXPECT_EQ(refused.code, 4) << refused.err;
    EXPECT_TRUE(contains(refused.err, input));
  }
  EXPECT_EQ(simplify(work, work.path("missing.ply"), "o.ply", {"--ratio", "0.5"}).code, 3);
  EXPECT_EQ(work.files(), (std::set<std::string>{"beyond.off", "nan.obj"}));
}

TEST(SimplifyCommand, FiveWhenTheTargetIsOutOfReach) {
  const Workplace work;
  for (const Arguments& target : {Arguments{"--vertices", "3"}, Arguments{"--vertices", "1M"}, Arguments{"--faces", "1M"}}) {
    const Outcome refused = simplify(work, kMesh, "o.ply", target);
    EXPECT_EQ(refused.code, 5) << refused.err;
    EXPECT_TRUE(work.files().empty());
  }
  EXPECT_TRUE(contains(simplify(work, kMesh, "o.ply", {"--vertices", "1M"}).err, "6475"));
  const Outcome partial = simplify(work, kMesh, "o.ply", {"--faces", "1M", "--allow-partial", "--json", "-"});
  EXPECT_EQ(partial.code, 5);
  EXPECT_EQ(read_geometry(work.path("o.ply")).triangles.size(), 12946u);
  EXPECT_FALSE(partial.json()["warnings"].empty());
}

TEST(SimplifyCommand, SevenAndEight) {
  const Workplace work;
  EXPECT_EQ(simplify(work, kMesh, "o.ply", {"--ratio", "0.1", "--max-memory", "1M"}).code, 7);
  EXPECT_EQ(simplify(work, kMesh, "no/such/o.ply", {"--ratio", "0.1"}).code, 8);
  const std::string existing = work.write("existing.ply", "precious");
  EXPECT_EQ(simplify(work, kMesh, "existing.ply", {"--ratio", "0.1"}).code, 8);
  EXPECT_EQ(slurp(existing), "precious");
  EXPECT_EQ(simplify(work, kMesh, "o.ply", {"--ratio", "0.1", "--dry-run"}).code, 0);
  EXPECT_EQ(work.files(), std::set<std::string>{"existing.ply"});
}

TEST(SimplifyCommand, AnInterruptedRunLeavesNothing) {
  const Workplace work;
  const pid_t child = work.start({"simplify", data("meshes/armadillo.ply"), "-o", work.path("o.ply"), "--max-error", "0.01%",
                                  "--progress", "json", "--json", work.path("report.json")});
  for (int i = 0; i < 5000 && work.said_err().find("collapse") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ::kill(child, SIGINT);
  EXPECT_EQ(work.finish(child).code, 130);
  EXPECT_TRUE(work.files().empty());
}

}  // namespace
}  // namespace shapelight::cli_test
