#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "point_files.hpp"

namespace shapelight {
namespace {

using test::TempFolder;

std::optional<FormatInfo> find(std::string_view name) {
  for (const FormatInfo& format : supported_formats()) {
    if (format.name == name) return format;
  }
  return std::nullopt;
}

TEST(Io, ListsFormats) {
  for (const char* name : {"ply", "obj", "stl", "off", "pcd", "xyz", "las"}) {
    ASSERT_TRUE(find(name).has_value()) << name;
    EXPECT_TRUE(find(name)->can_read && find(name)->can_write) << name;
  }
  for (const char* name : {"ptx", "png", "osu", "rif"}) {
    ASSERT_TRUE(find(name).has_value()) << name;
    EXPECT_TRUE(find(name)->can_read && !find(name)->can_write) << name;
  }
  for (const char* name : {"laz", "e57"}) {
    ASSERT_TRUE(find(name).has_value()) << name;
    EXPECT_FALSE(find(name)->can_read || find(name)->can_write) << name;
  }
}

TEST(Io, ExtensionsAreCaseInsensitive) {
  const TempFolder folder;
  const std::string bunny = test::contents_of(test::data_file("malformed/quirk_trimesh_crlf_ascii.ply"));
  EXPECT_EQ(read_geometry(folder.file("A.PLY", bunny)).size(), 4u);
}

TEST(Io, MissingFilesAreReadErrors) {
  for (const char* name : {"missing.ply", "missing.laz", "missing.unknown"}) {
    EXPECT_THROW((void)read_geometry(name), ReadError) << name;
  }
}

TEST(Io, FormatsOfThePythonPackageAreNamed) {
  const TempFolder folder;
  for (const char* name : {"a.laz", "a.copc.laz", "a.E57"}) {
    EXPECT_NE(test::refusal(folder.file(name, "x")).find("Python package"), std::string::npos) << name;
  }
}

TEST(Io, UnknownExtensions) {
  const TempFolder folder;
  EXPECT_NE(test::refusal(folder.file("a.doc", "x")).find("unknown extension '.doc', expected one of .ply"),
            std::string::npos);
  Geometry g;
  g.positions = {{0, 0, 0}};
  EXPECT_THROW((void)write_geometry(folder.file("a.ptx"), g), InvalidInput);
  EXPECT_THROW((void)write_geometry(folder.file("a"), g), InvalidInput);
}

TEST(Io, WritesOverOnlyWhenAllowed) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{0, 0, 0}};
  (void)folder.file("a.ply", "old");
  EXPECT_THROW((void)write_geometry(folder.file("a.ply"), g), WriteError);
  EXPECT_EQ(test::contents_of(folder.file("a.ply")), "old");
  (void)write_geometry(folder.file("a.ply"), g, {.overwrite = true});
  EXPECT_EQ(read_geometry(folder.file("a.ply")).size(), 1u);
}

TEST(Io, CancelledWritingLeavesNothing) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{0, 0, 0}};
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW((void)write_geometry(folder.file("a.ply"), g, {}, {.stop = stop.get_token()}), Cancelled);
  EXPECT_TRUE(std::filesystem::is_empty(folder.file("a.ply").parent_path()));
}

Geometry two_points() {
  Geometry geometry;
  geometry.positions = {{1, 2, 3}, {4, 5, 6}};
  return geometry;
}

TEST(Io, AnotherLibrarysFormatIsReadAndWritten) {
  const TempFolder folder;
  register_format({"twopoints",
                   {".twopoints"},
                   "for this test",
                   [](const auto&, const ReadOptions&, const RunContext&) { return two_points(); },
                   [](const auto& temporary, const Geometry& geometry, const WriteOptions&, const RunContext&) {
                     std::ofstream(temporary) << geometry.size() << " points";
                     return std::vector<std::string>{"colour"};
                   }});
  ASSERT_TRUE(find("twopoints").has_value());
  EXPECT_TRUE(find("twopoints")->can_read && find("twopoints")->can_write);
  const std::string path = folder.file("a.twopoints", "");
  EXPECT_EQ(read_geometry(path).positions, two_points().positions);
  EXPECT_EQ(read_geometry(path).format, "twopoints");
  EXPECT_EQ(write_geometry(path, two_points(), {.overwrite = true}), std::vector<std::string>{"colour"});
  EXPECT_EQ(test::contents_of(path), "2 points");
}

TEST(Io, AnotherLibrarysFailureLeavesTheTargetAlone) {
  const TempFolder folder;
  register_format({"failing", {".failing"}, "for this test", {}, [](const auto& temporary, auto&&...) {
                     std::ofstream(temporary) << "half";
                     throw WriteError("out of paper");
                     return std::vector<std::string>{};
                   }});
  const std::string path = folder.file("a.failing", "old");
  EXPECT_THROW((void)write_geometry(path, two_points(), {.overwrite = true}), WriteError);
  EXPECT_EQ(test::contents_of(path), "old");
  EXPECT_THROW((void)read_geometry(path), FormatError);
}

TEST(Io, AnExtensionHasOneOwner) { EXPECT_THROW(register_format({"mine", {".ply"}, "", {}, {}}), InvalidInput); }

}  // namespace
}  // namespace shapelight
