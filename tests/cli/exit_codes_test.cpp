#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "cli/command.hpp"

// Every exit code of the interface, what is said then, and that nothing half-written is left.
namespace shapelight::cli_test {
namespace {

using io::test::contains;

TEST(ExitCode, ZeroWhenTheTargetIsMet) {
  const Workplace work;
  const Outcome done = work.run({"sample", data("meshes/fandisk.off"), "-o", work.path("o.ply"), "--count", "100"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.out, "") << "words belong on stderr";
  EXPECT_EQ(work.files(), std::set<std::string>{"o.ply"});
  EXPECT_EQ(read_geometry(work.path("o.ply")).size(), 100u);
  for (const Arguments& words : {Arguments{"--help"}, Arguments{"--version"}, Arguments{"sample", "--help"}, Arguments{"formats"}}) {
    const Outcome said = work.run(words);
    EXPECT_EQ(said.code, 0);
    EXPECT_NE(said.out, "");
  }
}

struct BadUsage {
  Arguments options;
  const char* message;
};

TEST(ExitCode, TwoForBadUsage) {
  const std::vector<BadUsage> cases = {{{}, "exactly one of --count, --ratio and --spacing"},
                                       {{"--ratio", "0.1", "--count", "5"}, "exactly one of"},
                                       {{"--ratio", "0"}, "--ratio: '0'"},
                                       {{"--ratio", "1.5"}, "--ratio: '1.5'"},
                                       {{"--ratio", "-0.1"}, "--ratio: '-0.1'"},
                                       {{"--ratio", "nan"}, "--ratio: 'nan'"},
                                       {{"--count", "0"}, "--count: '0'"},
                                       {{"--count", "1.5"}, "--count: '1.5'"},
                                       {{"--count", "abc"}, "--count: 'abc'"},
                                       {{"--spacing", "0"}, "--spacing: '0'"},
                                       {{"--spacing", "5m"}, "--spacing: '5m'"},
                                       {{"--ratio", "0.1", "--method", "magic"}, "shape|random|voxel"},
                                       {{"--ratio", "0.1", "--preset", "magic"}, "detail|fast|paper"},
                                       {{"--ratio", "0.1", "--local-weight", "1.5"}, "--local-weight: 1.5"},
                                       {{"--ratio", "0.1", "--local-weight", "x"}, "--local-weight: 'x'"},
                                       {{"--ratio", "0.1", "--neighbors", "4.5"}, "whole number"},
                                       {{"--ratio", "0.1", "--seed", "-1"}, "--seed"},
                                       {{"--ratio", "0.1", "--threads", "-1"}, "--threads"},
                                       {{"--ratio", "0.1", "--max-memory", "much"}, "--max-memory: 'much'"},
                                       {{"--ratio", "0.1", "--progress", "loud"}, "--progress"},
                                       {{"--ratio", "0.1", "--intrinsics", "1,2,3"}, "fx,fy,cx,cy"},
                                       {{"--ratio", "0.1", "--keep", "colour"}, "--keep: no attribute 'colour'"},
                                       {{"--ratio", "0.1", "--drop", "colour"}, "--drop: no attribute 'colour'"},
                                       {{"--ratio", "0.1", "--frobnicate"}, "--frobnicate"}};
  const Workplace work;
  for (const BadUsage& bad : cases) {
    Arguments arguments = {"sample", data("clouds/simple.las"), "-o", work.path("o.ply")};
    arguments.insert(arguments.end(), bad.options.begin(), bad.options.end());
    const Outcome refused = work.run(arguments);
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_TRUE(contains(refused.err, bad.message));
    EXPECT_TRUE(work.files().empty());
  }
  for (const Arguments& arguments : {Arguments{}, Arguments{"magic"}, Arguments{"sample"}, Arguments{"sample", "a.ply"},
                                     Arguments{"info"}, Arguments{"convert", data("clouds/simple.las")}}) {
    EXPECT_EQ(work.run(arguments).code, 2);
  }
  const Outcome unknown = work.run({"sample", data("clouds/simple.las"), "-o", work.path("o.xyz3"), "--ratio", "0.1"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(contains(unknown.err, ".ply")) << "names what can be written";
}

TEST(ExitCode, ThreeWhenTheInputCannotBeRead) {
  const Workplace work;
  for (const std::string& input : {work.path("missing.ply"), work.path("no/such/folder.ply")}) {
    const Outcome failed = work.run({"sample", input, "-o", work.path("o.ply"), "--ratio", "0.1"});
    EXPECT_EQ(failed.code, 3) << failed.err;
    EXPECT_TRUE(contains(failed.err, input));
  }
  std::filesystem::create_directory(work.path("folder.ply"));
  EXPECT_EQ(work.run({"info", work.path("folder.ply")}).code, 3);
}

TEST(ExitCode, FiveWhenTheCountCannotBeReached) {
  const Workplace work;
  const Arguments asked = {"sample", data("scans/bun000_quarter.rif"), "-o", work.path("o.ply"), "--count", "1M", "--json", "-"};
  const Outcome refused = work.run(asked);
  EXPECT_EQ(refused.code, 5) << refused.err;
  EXPECT_TRUE(contains(refused.err, "1000000"));
  EXPECT_TRUE(contains(refused.err, "2524")) << "says how far it got";
  EXPECT_TRUE(work.files().empty());

  Arguments partial = asked;
  partial.push_back("--allow-partial");
  const Outcome written = work.run(partial);
  EXPECT_EQ(written.code, 5);
  EXPECT_EQ(read_geometry(work.path("o.ply")).size(), 2524u);
  EXPECT_EQ(written.json()["counts"]["out"], 2524);
  EXPECT_FALSE(written.json()["warnings"].empty());
}

TEST(ExitCode, SevenWhenTheMemoryBudgetIsTooSmall) {
  const Workplace work;
  const Outcome refused = work.run(
      {"sample", data("meshes/fandisk.off"), "-o", work.path("o.ply"), "--ratio", "0.1", "--max-memory", "1M"});
  EXPECT_EQ(refused.code, 7) << refused.err;
  EXPECT_TRUE(contains(refused.err, "--max-memory 1M"));
  EXPECT_TRUE(work.files().empty());
  EXPECT_EQ(work.run({"sample", data("meshes/fandisk.off"), "-o", work.path("o.ply"), "--ratio", "0.1", "--max-memory", "4G"}).code, 0);
}

TEST(ExitCode, EightWhenTheOutputCannotBeWritten) {
  const Workplace work;
  const std::string input = work.path("input.las");
  std::filesystem::copy_file(data("clouds/simple.las"), input);
  const std::string before = io::test::slurp(input);
  const auto code = [&](const std::string& output, const Arguments& more = {}) {
    Arguments arguments = {"sample", input, "-o", output, "--ratio", "0.1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = work.run(arguments);
    if (outcome.code == 8) {
      EXPECT_TRUE(contains(outcome.err, output)) << "names the file";
    }
    return outcome.code;
  };
  EXPECT_EQ(code(work.path("no/such/folder.ply")), 8);
  const std::string existing = work.write("existing.ply", "precious");
  EXPECT_EQ(code(existing), 8);
  EXPECT_EQ(io::test::slurp(existing), "precious");
  EXPECT_EQ(code(input), 8);
  EXPECT_EQ(code(input, {"--force"}), 8);
  std::filesystem::create_hard_link(input, work.path("same.las"));
  EXPECT_EQ(code(work.path("same.las"), {"--force"}), 8) << "the input under another name";
  std::filesystem::create_directory(work.path("folder.ply"));
  EXPECT_EQ(code(work.path("folder.ply"), {"--force"}), 8);
  EXPECT_EQ(io::test::slurp(input), before);
  EXPECT_EQ(work.files(), (std::set<std::string>{"input.las", "existing.ply", "same.las", "folder.ply"}));
  EXPECT_EQ(code(existing, {"--force"}), 0);
  EXPECT_NE(io::test::slurp(existing), "precious");
}

TEST(ExitCode, TheReportNeverReplacesInputOrOutput) {
  const Workplace work;
  const std::string input = work.path("input.las");
  std::filesystem::copy_file(data("clouds/simple.las"), input);
  const std::string before = io::test::slurp(input);
  for (const std::string& report : {input, work.path("o.ply"), work.path("./o.ply")}) {
    const Outcome refused =
        work.run({"sample", input, "-o", work.path("o.ply"), "--ratio", "0.1", "--json", report, "--force"});
    EXPECT_EQ(refused.code, 8) << report << refused.err;
  }
  EXPECT_EQ(io::test::slurp(input), before);
  EXPECT_EQ(work.files(), std::set<std::string>{"input.las"});
}

// Starts a long run, waits for its first sign of progress, and sends the signal.
Outcome interrupted(const Workplace& work, int signal) {
  const pid_t child = work.start({"sample", data("clouds/autzen_trim.las"), "-o", work.path("o.ply"), "--ratio", "0.5",
                                  "--preset", "paper", "--progress", "json", "--json", work.path("report.json")});
  for (int i = 0; i < 5000 && work.said_err().find("fraction") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ::kill(child, signal);
  return work.finish(child);
}

TEST(ExitCode, InterruptedAndTerminatedRunsLeaveNothing) {
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
    const Workplace work;
    const Outcome stopped = interrupted(work, signal);
    EXPECT_EQ(stopped.code, code) << stopped.err;
    EXPECT_TRUE(contains(stopped.err, "nothing was written"));
    EXPECT_TRUE(work.files().empty());
  }
}

TEST(Malformed, HostileFilesAreRefusedInOneLine) {
  // Odd, but within their formats: holes, a NaN time stamp, triangles that share no corner.
  const std::set<std::string> legal = {"meshlab_non_manif_hole.ply", "pdal_gps-time-nan.las", "trimesh_soup.stl"};
  const Workplace work;
  std::size_t hostile = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data("malformed"))) {
    const std::string name = entry.path().filename();
    SCOPED_TRACE(name);
    const bool fine = name.rfind("quirk_", 0) == 0 || legal.contains(name);
    const Outcome info = work.run({"info", entry.path()});
    const Outcome convert = work.run({"convert", entry.path(), work.path("o.ply"), "--force", "-q"});
    EXPECT_EQ(info.code, fine ? 0 : 4) << info.err;
    EXPECT_EQ(convert.code, fine ? 0 : 4) << convert.err;
    if (fine) {
      EXPECT_GT(read_geometry(work.path("o.ply")).size(), 0u);
      std::filesystem::remove(work.path("o.ply"));
    } else {
      ++hostile;
      EXPECT_EQ(info.out, "");
      EXPECT_EQ(lines_of(info.err).size(), 1u) << info.err;
      EXPECT_TRUE(contains(info.err, name)) << "names the file";
    }
    EXPECT_TRUE(work.files().empty());
  }
  EXPECT_GE(hostile, 20u);
}

TEST(Malformed, FormatsOfThePythonPackageAreNamed) {
  const Workplace work;
  for (const char* file : {"clouds/simple.laz", "malformed/e57_bad-crc.e57"}) {
    const Outcome refused = work.run({"info", data(file)});
    EXPECT_EQ(refused.code, 4);
    EXPECT_TRUE(contains(refused.err, "Python package"));
  }
}

}  // namespace
}  // namespace shapelight::cli_test
