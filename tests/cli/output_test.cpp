#include <gtest/gtest.h>

#include "cli/command.hpp"

// What a run writes: attributes, columns, the report, progress, pictures.
namespace shapelight::cli_test {
namespace {

using io::test::contains;
using io::test::slurp;

// The sample's points and attributes are those of the input at source_index, type and value.
void expect_attributes_travel(const std::string& input, const std::string& output_name, bool exact_positions = true) {
  SCOPED_TRACE(input + " -> " + output_name);
  const Workplace work;
  const Outcome done = work.run({"sample", input, "-o", work.path(output_name), "--ratio", "0.1", "--index-field"});
  ASSERT_EQ(done.code, 0) << done.err;
  const Geometry before = read_geometry(input);
  const Geometry after = read_geometry(work.path(output_name));
  const Column* source = after.attributes.find("source_index");
  ASSERT_NE(source, nullptr);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto from = static_cast<std::size_t>(source->as_double(i));
    ASSERT_LT(from, before.size());
    if (i > 0) {
      EXPECT_GT(source->as_double(i), source->as_double(i - 1)) << "file order";
    }
    if (exact_positions) {
      ASSERT_EQ(after.positions[i], before.positions[from]);
    }
  }
  for (const Column& column : before.attributes.columns()) {
    const Column* same = after.attributes.find(column.name);
    ASSERT_NE(same, nullptr) << column.name << " was lost";
    EXPECT_EQ(same->type(), column.type()) << column.name;
    for (std::size_t i = 0; i < after.size(); ++i) {
      ASSERT_EQ(same->as_double(i), column.as_double(static_cast<std::size_t>(source->as_double(i)))) << column.name;
    }
  }
}

std::string ply_with_many_attributes() {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double y\nproperty double z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float intensity\n"
      "property uchar classification\nproperty double gps_time\nproperty short temperature\nproperty uint station\nend_header\n";
  for (int i = 0; i < 400; ++i) {
    std::ostringstream row;
    row.precision(17);
    row << 512000.125 + i % 20 << ' ' << 4.8e6 + i / 20 << ' ' << 0.01 * ((i * 7) % 13) << ' ' << i % 256 << ' ' << i * 3 % 256
        << ' ' << i * 5 % 256 << ' ' << 0.25 * i << ' ' << i % 19 << ' ' << 3.0e8 + 0.001 * i << ' ' << 100 - i << ' '
        << 4000000000u + static_cast<unsigned>(i);
    text += row.str() + "\n";
  }
  return text;
}

TEST(Attributes, TravelWithTheirTypes) {
  const Workplace work;
  expect_attributes_travel(work.write("many.ply", ply_with_many_attributes()), "o.ply");
  expect_attributes_travel(work.path("many.ply"), "o.pcd");
  expect_attributes_travel(data("clouds/simple.las"), "o.las");
  expect_attributes_travel(data("clouds/simple.las"), "o.ply");
  expect_attributes_travel(data("scans/table_scene_mug_640x480.pcd"), "o.pcd");
  expect_attributes_travel(data("scans/table_scene_mug_640x480.pcd"), "o.ply");
  expect_attributes_travel(data("meshes/bunny.ply"), "o.ply");
}

TEST(Attributes, WhatAFormatCannotHoldIsSaid) {
  const Workplace work;
  const std::string input = work.write("many.ply", ply_with_many_attributes());
  const Outcome done = work.run({"convert", input, work.path("o.stl"), "--json", "-"});
  if (done.code == 0) {
    EXPECT_TRUE(contains(done.err, "temperature"));
  }
  const Outcome off = work.run({"convert", input, work.path("o.off"), "--json", "-"});
  ASSERT_EQ(off.code, 0) << off.err;
  EXPECT_TRUE(contains(off.err, "cannot hold 'temperature'"));
  const auto dropped = off.json()["attributes"]["dropped"].get<std::set<std::string>>();
  EXPECT_TRUE(dropped.contains("temperature"));
}

TEST(Attributes, KeepAndDropChoose) {
  const Workplace work;
  const std::string input = work.write("many.ply", ply_with_many_attributes());
  const auto names = [&](const Arguments& more) {
    Arguments arguments = {"sample", input, "-o", work.path("o.ply"), "--ratio", "0.2", "--force", "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome done = work.run(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    std::set<std::string> found;
    const Geometry written = read_geometry(work.path("o.ply"));
    for (const Column& column : written.attributes.columns()) found.insert(column.name);
    EXPECT_EQ(done.json()["attributes"]["kept"].get<std::set<std::string>>(), found);
    return found;
  };
  using Names = std::set<std::string>;
  EXPECT_EQ(names({"--keep", "intensity,gps_time"}), (Names{"intensity", "gps_time"}));
  EXPECT_EQ(names({"--drop", "red,green,blue", "--drop", "station"}),
            (Names{"intensity", "classification", "gps_time", "temperature"}));
  EXPECT_EQ(names({"--keep", "intensity", "--index-field", "--order"}), (Names{"intensity", "source_index", "order"}));
}

TEST(Sample, OrderRanksThePoints) {
  const Workplace work;
  const auto sampled = [&](const char* count) {
    const Outcome done = work.run({"sample", data("meshes/fandisk.off"), "-o", work.path("o.ply"), "--count", count, "--order",
                                   "--index-field", "--force"});
    EXPECT_EQ(done.code, 0) << done.err;
    const Geometry written = read_geometry(work.path("o.ply"));
    std::vector<double> by_rank(written.size(), -1.0);
    for (std::size_t i = 0; i < written.size(); ++i) {
      by_rank.at(static_cast<std::size_t>(written.attributes.find("order")->as_double(i))) =
          written.attributes.find("source_index")->as_double(i);
    }
    return by_rank;
  };
  const std::vector<double> large = sampled("500"), small = sampled("50");
  EXPECT_EQ(std::count(large.begin(), large.end(), -1.0), 0) << "every rank occurs once";
  EXPECT_TRUE(std::equal(small.begin(), small.end(), large.begin()));
}

TEST(Sample, BytesAreTheSameForAnyThreadsAndEveryTime) {
  for (const char* file : {"clouds/simple.las", "meshes/fandisk.off", "scans/dragonStandRight_0.ply"}) {
    const Workplace work;
    std::string expected;
    for (const char* threads : {"1", "1", "2", "3", "8", "0"}) {
      const Outcome done = work.run({"sample", data(file), "-o", work.path("o.ply"), "--ratio", "10%", "--threads", threads, "--force"});
      ASSERT_EQ(done.code, 0) << done.err;
      const std::string bytes = slurp(work.path("o.ply"));
      if (expected.empty()) expected = bytes;
      EXPECT_TRUE(bytes == expected) << file << ", " << threads << " threads";
    }
  }
}

TEST(Sample, DryRunWritesNothing) {
  const Workplace work;
  const Outcome done =
      work.run({"sample", data("clouds/simple.las"), "-o", work.path("o.ply"), "--ratio", "0.1", "--dry-run", "--json", "-"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.json()["counts"]["out"], 107);
  EXPECT_TRUE(work.files().empty());
  EXPECT_EQ(work.run({"render", data("clouds/simple.las"), "-o", work.path("o.png"), "--dry-run"}).code, 0);
  EXPECT_EQ(work.run({"fields", data("clouds/simple.las"), "-o", work.path("o.ply"), "--dry-run"}).code, 0);
  EXPECT_TRUE(work.files().empty());
}

TEST(Sample, SpacingMayBeAShareOfTheDiagonal) {
  const Workplace work;
  const double diagonal = bounding_box(testing::read_data("meshes/fandisk.off").positions).diagonal();
  const auto bytes = [&](const std::string& spacing) {
    const Outcome done = work.run({"sample", data("meshes/fandisk.off"), "-o", work.path("o.ply"), "--spacing", spacing, "--force"});
    EXPECT_EQ(done.code, 0) << done.err;
    return slurp(work.path("o.ply"));
  };
  std::ostringstream absolute;
  absolute.precision(17);
  absolute << 0.05 * diagonal;
  EXPECT_TRUE(bytes("5%") == bytes(absolute.str()));
}

TEST(Report, HasTheKeysOfTheInterface) {
  const Workplace work;
  const Outcome done = work.run({"sample", data("meshes/bunny.ply"), "-o", work.path("o.ply"), "--ratio", "0.1", "--json",
                                 work.path("report.json"), "--threads", "2"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto report = nlohmann::json::parse(slurp(work.path("report.json")));
  EXPECT_EQ(report["schema"], "shapelight.report/1");
  EXPECT_EQ(report["command"], "sample");
  EXPECT_FALSE(report["version"].get<std::string>().empty());
  EXPECT_EQ(report["input"]["path"], data("meshes/bunny.ply"));
  EXPECT_EQ(report["input"]["format"], "ply");
  EXPECT_EQ(report["input"]["vertices"], 35947);
  EXPECT_EQ(report["input"]["faces"], 69451);
  EXPECT_EQ(report["input"]["kind"], "mesh");
  EXPECT_EQ(report["options"]["method"], "shape");
  EXPECT_EQ(report["options"]["preset"], "detail");
  EXPECT_EQ(report["options"]["ratio"], 0.1);
  EXPECT_EQ(report["options"]["local-weight"], 0.65);
  EXPECT_EQ(report["counts"]["in"], 35947);
  EXPECT_EQ(report["counts"]["out"], 3595);
  double sum = 0.0;
  for (const char* phase : {"read", "sample", "write"}) sum += report["seconds"][phase].get<double>();
  EXPECT_GE(report["seconds"]["total"].get<double>(), sum);
  EXPECT_GT(report["peak_memory_bytes"].get<std::uint64_t>(), 1000000u);
  EXPECT_TRUE(report["attributes"]["kept"].is_array());
  EXPECT_TRUE(report["attributes"]["dropped"].is_array());
  EXPECT_TRUE(report["warnings"].is_array());
  EXPECT_TRUE(report["result"].is_object());
}

TEST(Report, EveryCommandWritesOne) {
  const Workplace work;
  const std::string input = data("clouds/simple.las");
  for (const Arguments& arguments :
       {Arguments{"info", input}, Arguments{"convert", input, work.path("a.ply")}, Arguments{"fields", input, "-o", work.path("b.ply")},
        Arguments{"metrics", input, input}, Arguments{"render", input, "-o", work.path("c.png"), "--width", "64", "--height", "48"}}) {
    Arguments with_report = arguments;
    with_report.insert(with_report.end(), {"--json", "-"});
    const Outcome done = work.run(with_report);
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.json()["schema"], "shapelight.report/1");
    EXPECT_EQ(done.json()["command"], arguments[0]);
    EXPECT_TRUE(done.json()["result"].is_object()) << arguments[0];
  }
}

TEST(Report, AnExistingOneIsKept) {
  const Workplace work;
  const std::string report = work.write("report.json", "precious");
  EXPECT_EQ(work.run({"info", data("clouds/simple.las"), "--json", report}).code, 8);
  EXPECT_EQ(slurp(report), "precious");
}

TEST(Progress, JsonLinesAreMonotone) {
  const Workplace work;
  const Outcome done = work.run({"sample", data("meshes/fandisk.off"), "-o", work.path("o.ply"), "--ratio", "0.1", "--preset",
                                 "paper", "--progress", "json", "-q"});
  ASSERT_EQ(done.code, 0) << done.err;
  double last = -1.0;
  const std::vector<std::string> lines = lines_of(done.err);
  EXPECT_GT(lines.size(), 5u);
  EXPECT_LE(lines.size(), 101u);
  for (const std::string& line : lines) {
    const auto step = nlohmann::json::parse(line);
    EXPECT_GE(step["fraction"].get<double>(), last);
    EXPECT_FALSE(step["phase"].get<std::string>().empty());
    last = step["fraction"];
  }
  EXPECT_EQ(last, 1.0);
}

TEST(Progress, QuietMeansQuiet) {
  const Workplace work;
  const Outcome done = work.run({"sample", data("meshes/bunny.ply"), "-o", work.path("o.ply"), "--ratio", "0.1", "-q"});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.out + done.err, "");
}

TEST(Formats, ListsWhatCanBeReadAndWritten) {
  const Workplace work;
  const std::string list = work.run({"formats"}).out;
  for (const char* extension : {".ply", ".obj", ".stl", ".off", ".pcd", ".xyz", ".las", ".ptx", ".png", ".rif", ".abs"}) {
    EXPECT_TRUE(contains(list, extension));
  }
}

TEST(Fields, AddsTheColumns) {
  const Workplace work;
  const Outcome done = work.run({"fields", data("meshes/fandisk.off"), "-o", work.path("o.ply")});
  ASSERT_EQ(done.code, 0) << done.err;
  const Geometry written = read_geometry(work.path("o.ply"));
  EXPECT_EQ(written.size(), 6475u);
  EXPECT_EQ(written.triangles.size(), 12946u);
  for (const char* name : {"shape_index", "curvedness", "illumination", "reflectance", "segment", "importance"}) {
    EXPECT_NE(written.attributes.find(name), nullptr) << name;
  }
}

TEST(Render, DrawsAPicture) {
  const Workplace work;
  const Outcome done = work.run({"render", data("meshes/fandisk.off"), data("clouds/simple.las"), "-o", work.path("o.png"),
                                 "--color", "none,z", "--width", "160", "--height", "120"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(slurp(work.path("o.png")).substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(work.run({"render", data("meshes/fandisk.off"), "-o", work.path("o.jpg")}).code, 2);
  EXPECT_EQ(work.run({"render", data("meshes/fandisk.off"), "-o", work.path("o.png")}).code, 8) << "exists";
  EXPECT_EQ(work.run({"render", data("meshes/fandisk.off"), "-o", work.path("p.png"), "--color", "no_such_field"}).code, 2);
}

TEST(Metrics, MeasureASample) {
  const Workplace work;
  ASSERT_EQ(work.run({"sample", data("meshes/fandisk.off"), "-o", work.path("o.ply"), "--ratio", "0.1"}).code, 0);
  const Outcome done = work.run({"metrics", data("meshes/fandisk.off"), work.path("o.ply"), "--json", "-"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_GT(done.json()["result"]["coverage_max"].get<double>(), 0.0);
  const Outcome self = work.run({"metrics", work.path("o.ply"), work.path("o.ply"), "--json", "-"});
  EXPECT_EQ(self.json()["result"]["coverage_max"], 0.0);
}

}  // namespace
}  // namespace shapelight::cli_test
