#include <cmath>

#include "io/file_support.hpp"

namespace shapelight::io::test {
namespace {

const std::filesystem::path kImage = std::filesystem::path(SHAPELIGHT_DATA_DIR) / "scans/tum_depth_640x480.png";

ReadOptions tum_camera() {
  ReadOptions options;
  options.intrinsics = CameraIntrinsics{525, 525, 319.5, 239.5};
  options.depth_scale = 5000;
  return options;
}

TEST(DepthPng, ProjectsBackThroughThePinhole) {
  const Geometry image = read_path(read_depth_png, kImage, tum_camera());
  EXPECT_EQ(image.size(), 248250u);
  ASSERT_TRUE(image.grid);
  EXPECT_EQ(image.grid->width, 640u);
  EXPECT_EQ(image.grid->height, 480u);
  EXPECT_EQ(*image.viewpoint, Vec3::Zero());
  EXPECT_EQ(image.coordinate_type, ScalarType::Float64);
  for (std::size_t i = 0; i < image.grid->pixel.size(); i += 997) {
    const Index point = image.grid->pixel[i];
    if (point == kNoIndex) continue;
    const Vec3 p = image.positions[point];
    EXPECT_NEAR(525 * p.x() / p.z() + 319.5, static_cast<double>(i % 640), 1e-9);
    EXPECT_NEAR(525 * p.y() / p.z() + 239.5, static_cast<double>(i / 640), 1e-9);
    EXPECT_NEAR(std::round(5000 * p.z()), 5000 * p.z(), 1e-9);
    EXPECT_TRUE(p.z() > 0.3 && p.z() < 10.0);
  }
}

TEST(DepthPng, FindsTheCameraBesideTheImage) {
  const Geometry own = read_path(read_depth_png, kImage);
  EXPECT_EQ(own.positions, read_path(read_depth_png, kImage, tum_camera()).positions);

  const TempFolder folder;
  const std::filesystem::path copy = folder.write("a.depth.png", slurp(kImage));
  EXPECT_THROW(read_path(read_depth_png, copy), FormatError);
  folder.write("intrinsics.txt", "1 1 0 0\n");
  EXPECT_NEAR(read_path(read_depth_png, copy).positions[0].z(), 5 * own.positions[0].z(), 1e-9);
  folder.write("camera-intrinsics.txt", "525 0 319.5\n0 525 239.5 # row 2\n0 0 1\n");
  EXPECT_NEAR(read_path(read_depth_png, copy).positions[0].x(), 5 * own.positions[0].x(), 1e-9);
  folder.write("a.depth.intrinsics.txt", "525, 525, 319.5, 239.5, 5000");
  EXPECT_EQ(read_path(read_depth_png, copy).positions, own.positions);
  ReadOptions scale;
  scale.depth_scale = 2500;  // chosen by the caller, so it goes before the file's
  EXPECT_EQ(read_path(read_depth_png, copy, scale).positions[0].z(), 2 * own.positions[0].z());
  for (const std::string bad :
       {"525 525 319.5", "0 525 319.5 239.5", "525 525 319.5 nan", "1 2 3 4 5 6 7 8 9 10", "a"}) {
    folder.write("a.depth.intrinsics.txt", bad);
    EXPECT_THROW(read_path(read_depth_png, copy), FormatError) << bad;
  }
}

TEST(DepthPng, TellsHowToGiveTheCamera) {
  EXPECT_TRUE(contains(error_of(read_depth_png, slurp(kImage)), "--intrinsics fx,fy,cx,cy"));
}

TEST(DepthPng, ChecksTheOptions) {
  ReadOptions options = tum_camera();
  options.depth_scale = 0;
  EXPECT_THROW(read_path(read_depth_png, kImage, options), InvalidInput);
  options = tum_camera();
  options.intrinsics->fx = 0;
  EXPECT_THROW(read_path(read_depth_png, kImage, options), InvalidInput);
}

// One white pixel, 8 bits, and one grey pixel of 16 bits with value 0; made with zlib.
constexpr unsigned char kByteImage[] = {137, 80, 78,  71, 13, 10, 26, 10,  0,   0,  0,   13, 73,  72,  68,  82, 0,
                                        0,   0,  1,   0,  0,  0,  1,  8,   0,   0,  0,   0,  58,  126, 155, 85, 0,
                                        0,   0,  10,  73, 68, 65, 84, 120, 156, 99, 248, 15, 0,   1,   1,   1,  0,
                                        177, 56, 246, 20, 0,  0,  0,  0,   73,  69, 78,  68, 174, 66,  96,  130};
constexpr unsigned char kEmptyImage[] = {137, 80,  78,  71, 13, 10, 26, 10,  0,   0,  0,  13, 73,  72,  68, 82, 0,
                                         0,   0,   1,   0,  0,  0,  1,  16,  0,   0,  0,  0,  106, 238, 71, 22, 0,
                                         0,   0,   11,  73, 68, 65, 84, 120, 156, 99, 96, 96, 0,   0,   0,  3,  0,
                                         1,   184, 173, 58, 99, 0,  0,  0,   0,   73, 69, 78, 68,  174, 66, 96, 130};

template <std::size_t N>
std::string bytes_of(const unsigned char (&bytes)[N]) {
  return {reinterpret_cast<const char*>(bytes), N};
}

TEST(DepthPng, RefusesOtherImages) {
  EXPECT_TRUE(contains(error_of(read_depth_png, bytes_of(kByteImage)), "8 bits per channel, 1 channels, expected"));
  const TempFolder folder;
  EXPECT_THROW(read_path(read_depth_png, folder.write("a.png", bytes_of(kEmptyImage)), tum_camera()), FormatError);
  EXPECT_TRUE(contains(error_of(read_depth_png, "not a png"), "png: "));
  EXPECT_TRUE(contains(error_of(read_depth_png, ""), "too early"));
}

TEST(DepthPng, RefusesDamagedImages) {
  const std::string whole = slurp(kImage);
  EXPECT_TRUE(contains(error_of(read_depth_png, whole.substr(0, 20)), "too early"));
  EXPECT_TRUE(contains(error_of(read_depth_png, whole.substr(0, whole.size() / 2)), "too early"));
  std::string flipped = whole;
  flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 0x55);
  EXPECT_TRUE(contains(error_of(read_depth_png, flipped), "png: "));
}

// The header promises 60000 x 60000 pixels, with a valid checksum, and two bytes of data follow.
constexpr unsigned char kHugeImage[] = {137, 80,  78,  71,  13, 10,  26, 10,  0,   0,  0,  13, 73,  72, 68,  82,  0,
                                        0,   234, 96,  0,   0,  234, 96, 16,  0,   0,  0,  0,  245, 41, 246, 221, 0,
                                        0,   0,   10,  73,  68, 65,  84, 120, 156, 99, 96, 0,  0,   0,  2,   0,   1,
                                        72,  175, 164, 113, 0,  0,   0,  0,   73,  69, 78, 68, 174, 66, 96,  130};

TEST(DepthPng, RefusesSizesThatTheFileCannotHold) {
  EXPECT_TRUE(contains(error_of(read_depth_png, bytes_of(kHugeImage)), "60000 x 60000 pixels cannot come out of"));
}

}  // namespace
}  // namespace shapelight::io::test
