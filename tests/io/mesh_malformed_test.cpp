#include "core/random.hpp"
#include "io/file_support.hpp"

namespace shapelight::io::test {
namespace {

const std::filesystem::path kMalformed = std::filesystem::path(SHAPELIGHT_DATA_DIR) / "malformed";

// What each hostile file is refused for.
struct Refused {
  Reader reader;
  const char* file;
  const char* message;
};
const Refused kRefused[] = {
    {read_obj, "assimp_malformed.obj", "line 28: face has vertex index 0"},
    {read_obj, "assimp_box_UTF16BE.obj", "byte 0: the text is UTF-16"},
    {read_obj, "pdal_no_vertex.obj", "without a vertex"},
    {read_obj, "trimesh_notenoughindices.obj", "line 9: a face with 2 corners, expected at least 3"},
    {read_obj, "tinyobj_invalid-face-definition.obj", "line 15: a face with 1 corners"},
    {read_obj, "tinyobj_invalid-relative-vertex-index.obj", "line 1: face has vertex index -4"},
    {read_obj, "tinyobj_test-nan.obj", "line 12: vertex 1 belongs to a face and is not finite"},
    {read_obj, "tinyobj_zero-face-idx.obj", "line 16: face has vertex index 0"},
    {read_off, "assimp_OutOfMemory.off", "line 2: 353535235358 vertices and 6 faces do not fit"},
    {read_off, "assimp_invalid.off", "line 2: 3 vertices and 4 faces do not fit into the 45 bytes"},
    {read_stl, "trimesh_stl_empty_ascii.stl", "no facet"},
    {read_stl, "trimesh_stl_empty_bin.stl", "no facet"},
    {read_xyz, "pdal_badheader.txt", "line 1: column 'X' occurs twice"},
};

TEST(MeshMalformed, HostileFilesAreRefusedWithThePlace) {
  for (const auto& [reader, file, message] : kRefused) {
    try {
      (void)read_path(reader, kMalformed / file);
      ADD_FAILURE() << file << " was read";
    } catch (const FormatError& error) {
      EXPECT_TRUE(contains(error.what(), message));
      EXPECT_TRUE(contains(error.what(), file));
    }
  }
}

struct Accepted {
  Reader reader;
  const char* file;
  std::size_t points;
  std::size_t triangles;
};
const Accepted kAccepted[] = {
    {read_obj, "quirk_trimesh_negative_indices.obj", 8, 12},
    {read_off, "quirk_trimesh_comments.off", 8, 12},
    {read_off, "quirk_trimesh_whitespace.off", 8, 12},
    {read_stl, "quirk_assimp_triangle_with_two_solids.stl", 6, 2},
    {read_stl, "trimesh_soup.stl", 300, 100},
    {read_xyz, "quirk_pdal_missingheader.txt", 5, 0},
};

TEST(MeshMalformed, QuirksAreRead) {
  for (const auto& [reader, file, points, triangles] : kAccepted) {
    const Geometry geometry = read_path(reader, kMalformed / file);
    EXPECT_EQ(geometry.size(), points) << file;
    EXPECT_EQ(geometry.triangles.size(), triangles) << file;
  }
}

std::string damaged(std::string bytes, std::uint64_t seed) {
  const auto random = [&](std::uint64_t stream, std::size_t below) {
    return static_cast<std::size_t>(random_bits(seed, stream, 0) % below);
  };
  const std::size_t flips = random(0, 4);
  for (std::size_t k = 0; k < flips; ++k) {
    bytes[random(10 + k, bytes.size())] = static_cast<char>(random(20 + k, 256));
  }
  if (random(1, 3) == 0) bytes.resize(random(2, bytes.size()));
  if (random(3, 5) == 0) bytes.insert(random(4, bytes.size() + 1), bytes.substr(0, random(5, bytes.size() + 1)));
  return bytes;
}

// The smallest valid files, and a few larger ones cut off, so that damage often hits what matters.
std::vector<std::pair<Reader, std::string>> seeds() {
  std::vector<std::pair<Reader, std::string>> list;
  for (const auto& [reader, file, points, triangles] : kAccepted) list.emplace_back(reader, slurp(kMalformed / file));
  const Geometry mesh = square();
  list.emplace_back(read_obj,
                    "v 0 0 0 1 1 1\nv 1 0 0 0 0 0\nv 0 1 0 0 0 1\nvn 0 0 1\nvt 0 1\nf 1/1/1 2/1/1 \\\n-1/-1/-1\n");
  list.emplace_back(read_stl, write_bytes(write_stl, mesh).bytes);
  list.emplace_back(read_stl, write_bytes(write_stl, mesh, {.ascii = true}).bytes);
  list.emplace_back(read_off,
                    "STCNOFF\n3 1 0\n1 2 3 0 0 1 9 8 7 0.5 0.25\n1 2 3 0 0 1 9 8 7 0.5 0.25\n"
                    "1 2 4 0 0 1 9 8 7 0.5 0.25\n3 0 1 2\n");
  list.emplace_back(read_xyz, "# x y z red green blue\n1 2 3 4 5 6\n1 2 3 4 5 6\n");
  list.emplace_back(read_xyz, "2\n1 2 3 4 5 6 7\n1 2 3 4 5 6 7\n");
  list.emplace_back(read_ptx,
                    "1\n2\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 0 0 1\n2 0 0 1\n");
  list.emplace_back(read_osu, "1 rows\n2 columns\npixels (flag X Y Z):\n0 1\n0 1\n0 2\n0 3\n");
  list.emplace_back(read_rif, "|\nfloat ascii 1 2\n0 1\n0 2\n0 3\n1 0\n");
  list.emplace_back(read_depth_png,
                    slurp(std::filesystem::path(SHAPELIGHT_DATA_DIR) / "scans/tum_depth_640x480.png").substr(0, 4000));
  return list;
}

TEST(MeshMalformed, DamagedFilesEndInAnErrorOrAReadableGeometry) {
  const TempFolder folder;
  ReadOptions options;
  options.intrinsics = CameraIntrinsics{1, 1, 0, 0};
  std::size_t read = 0, refused = 0;
  for (const auto& [reader, bytes] : seeds()) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      const std::filesystem::path path = folder.write("input", damaged(bytes, seed));
      try {
        const Geometry geometry = read_path(reader, path, options);
        ++read;
        ASSERT_FALSE(geometry.positions.empty());
        for (const Triangle& triangle : geometry.triangles) {
          for (const Index vertex : triangle) ASSERT_LT(vertex, geometry.size());
        }
        for (const Column& column : geometry.attributes.columns()) ASSERT_EQ(column.size(), geometry.size());
        ASSERT_TRUE(geometry.corner_texcoords.empty() ||
                    geometry.corner_texcoords.size() == 3 * geometry.triangles.size());
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(read, 100u);
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace shapelight::io::test
