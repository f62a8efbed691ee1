#include <gtest/gtest.h>

#include <algorithm>

#include "point_files.hpp"

namespace shapelight {
namespace {

using test::TempFolder;

const FormatInfo* find(std::string_view name) {
  const auto formats = supported_formats();
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const FormatInfo& f) { return f.name == name; });
  return found == formats.end() ? nullptr : &*found;
}

TEST(Io, ListsFormats) {
  for (const char* name : {"ply", "obj", "stl", "off", "pcd", "xyz", "las"}) {
    ASSERT_NE(find(name), nullptr) << name;
    EXPECT_TRUE(find(name)->can_read && find(name)->can_write) << name;
  }
  for (const char* name : {"ptx", "png", "osu", "rif"}) {
    ASSERT_NE(find(name), nullptr) << name;
    EXPECT_TRUE(find(name)->can_read && !find(name)->can_write) << name;
  }
  for (const char* name : {"laz", "e57"}) {
    ASSERT_NE(find(name), nullptr) << name;
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

}  // namespace
}  // namespace shapelight
