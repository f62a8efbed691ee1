#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.hpp"
#include "point_files.hpp"

namespace shapelight {
namespace {

struct Expected {
  const char* file;
  const char* message;  // part of the refusal; empty: the file is read
  std::size_t points;
  std::size_t triangles;
};

// What data/malformed must end as.
TEST(MalformedPoints, EndAsDocumented) {
  const std::vector<Expected> cases = {
      {"assimp_crash-30d6d0f7.ply", "line 7: unknown property type", 0, 0},
      {"assimp_empty.ply", "expected the word ply", 0, 0},
      {"trimesh_ply_empty_header.ply", "no element vertex", 0, 0},
      {"trimesh_zero_vertices.ply", "0 vertices, expected at least one", 0, 0},
      {"pdal_no_z_property.ply", "lacks a scalar property x, y or z", 0, 0},
      {"open3d_short_row.ply", "line 13: element vertex 1: the row ends, expected nz", 0, 0},
      {"meshlab_non_manif_hole.ply", "", 432, 755},
      {"quirk_assimp_cube_binary_crlf_header.ply", "", 8, 12},
      {"quirk_assimp_cube_binary_first_byte_nl.ply", "", 8, 12},
      {"quirk_open3d_int8_overflow.ply", "", 2, 0},
      {"quirk_trimesh_crlf_ascii.ply", "", 4, 2},
      {"quirk_trimesh_points_ascii_with_lists.ply", "", 5, 0},
      {"quirk_trimesh_points_emptyface.ply", "", 1024, 0},
      {"pdal_missingheader.pcd", "line 1: unknown header line", 0, 0},
      {"quirk_pdal_utm17_comma_wrong_size.pcd", "", 10, 0},
      {"pdal_bad_vlr_count.las", "byte 429: variable length record 3 of 3", 0, 0},
      {"pdal_garbage_nVariableLength.las", "variable length record 1 of 1069128089", 0, 0},
      {"pdal_no-points.las", "1065 points of 34 bytes expected, 0 bytes left", 0, 0},
      {"pdal_gps-time-nan.las", "", 1, 0},
  };
  for (const Expected& expected : cases) {
    const auto path = test::data_file(std::string("malformed/") + expected.file);
    const std::string message = test::refusal(path);
    if (expected.message[0] != '\0') {
      EXPECT_NE(message.find(expected.message), std::string::npos) << expected.file << ": " << message;
      EXPECT_NE(message.find(expected.file), std::string::npos) << message;
    } else {
      ASSERT_EQ(message, "") << expected.file;
      const Geometry g = read_geometry(path);
      EXPECT_EQ(g.size(), expected.points) << expected.file;
      EXPECT_EQ(g.triangles.size(), expected.triangles) << expected.file;
    }
  }
}

TEST(MalformedPoints, OverflowingColumnIsWidened) {
  const Geometry g = read_geometry(test::data_file("malformed/quirk_open3d_int8_overflow.ply"));
  EXPECT_EQ(g.attributes.find("intensity")->type(), ScalarType::Int16);
  EXPECT_EQ(g.attributes.find("intensity")->to_doubles(), (std::vector<double>{100, 128}));
  EXPECT_EQ(g.warnings.size(), 1u);
}

TEST(MalformedPoints, FirstBodyByteMayBeNewline) {
  const Geometry g = read_geometry(test::data_file("malformed/quirk_assimp_cube_binary_first_byte_nl.ply"));
  EXPECT_LT(bounding_box(g.positions).diagonal(), 2.0);
}

TEST(MalformedPoints, CoordinatesKeepWhatTheTextSays) {
  const Geometry g = read_geometry(test::data_file("malformed/quirk_pdal_utm17_comma_wrong_size.pcd"));
  EXPECT_EQ(g.positions[0], Vec3(289814.15, 4320978.61, 170.76));
}

// Damaged copies of good files are refused or read, and what is read holds together.
TEST(MalformedPoints, MutationsNeverBreakReaders) {
  const test::TempFolder folder;
  Geometry packed = read_geometry(test::data_file("malformed/meshlab_non_manif_hole.ply"));
  packed.grid = RangeGrid{432, 1, std::vector<Index>(432, 5)};
  (void)write_geometry(folder.file("grid.ply"), packed);
  (void)write_geometry(folder.file("cloud.pcd"), packed);
  (void)write_geometry(folder.file("text.pcd"), packed, {.ascii = true});
  packed.attributes.set({"confidence", std::vector<float>(432, 1.0f)});
  (void)write_geometry(folder.file("fresh.las"), packed);
  const std::vector<std::filesystem::path> seeds = {
      test::data_file("malformed/meshlab_non_manif_hole.ply"),
      test::data_file("malformed/quirk_trimesh_crlf_ascii.ply"),
      test::data_file("malformed/quirk_trimesh_points_ascii_with_lists.ply"),
      test::data_file("malformed/quirk_pdal_utm17_comma_wrong_size.pcd"),
      test::data_file("clouds/simple.las"),
      folder.file("grid.ply"),
      folder.file("cloud.pcd"),
      folder.file("text.pcd"),
      folder.file("fresh.las")};
  std::uint64_t draw = 0;
  const auto below = [&](std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(random01(7, 1, draw++) * static_cast<double>(n)));
  };
  for (const auto& seed : seeds) {
    const std::string good = test::contents_of(seed);
    for (int round = 0; round < 60; ++round) {
      std::string bad = good;
      const std::size_t reach = round % 2 == 0 ? std::min<std::size_t>(bad.size(), 400) : bad.size();
      for (std::size_t n = 1 + below(4); n > 0; --n) bad[below(reach)] = static_cast<char>(below(256));
      if (round % 3 == 0) bad.resize(below(bad.size()));
      const auto path = folder.file("mutant" + seed.extension().string(), bad);
      try {
        const Geometry g = read_geometry(path);
        for (const Column& c : g.attributes.columns()) EXPECT_EQ(c.size(), g.size());
        for (const Triangle& t : g.triangles) EXPECT_LT(*std::max_element(t.begin(), t.end()), g.size());
        if (g.grid) {
          EXPECT_EQ(g.grid->pixel.size(), std::size_t{g.grid->width} * g.grid->height);
        }
      } catch (const FormatError& error) {
        EXPECT_NE(std::string(error.what()).find("mutant"), std::string::npos);
      }
    }
  }
}

}  // namespace
}  // namespace shapelight
