#include "shapelight/render/image.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("shapelight_render_" + std::to_string(::getpid()) + name);
}

Image noise(int width, int height) {
  Image image(width, height, {0, 0, 0});
  std::uint32_t state = 1;
  for (Pixel& pixel : image.pixels) {
    for (std::uint8_t& channel : pixel)
      channel = static_cast<std::uint8_t>((state = state * 1664525U + 1013904223U) >> 24);
  }
  return image;
}

TEST(WritePng, IsReadBackByLibpng) {
  const auto path = scratch("round.png");
  const Image image = noise(37, 11);
  write_png(path, image);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&header, path.c_str()), 0);
  ASSERT_EQ(header.width, 37U);
  ASSERT_EQ(header.height, 11U);
  EXPECT_EQ(header.format & PNG_FORMAT_FLAG_ALPHA, 0U);
  header.format = PNG_FORMAT_RGB;
  std::vector<Pixel> pixels(image.pixels.size());
  ASSERT_NE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr), 0);
  EXPECT_EQ(pixels, image.pixels);
  std::filesystem::remove(path);
}

TEST(WritePng, KeepsAnExistingFileUnlessAllowed) {
  const auto path = scratch("keep.png");
  std::ofstream(path) << "mine";
  EXPECT_THROW(write_png(path, noise(2, 2)), WriteError);
  std::ifstream kept(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(kept), {}), "mine");
  write_png(path, noise(2, 2), true);
  EXPECT_GT(std::filesystem::file_size(path), 50U);
  std::filesystem::remove(path);
}

TEST(WritePng, RefusesAnImageWithoutPixels) {
  EXPECT_THROW(write_png(scratch("none.png"), Image{}), InvalidInput);
  Image torn = noise(4, 4);
  torn.pixels.pop_back();
  EXPECT_THROW(write_png(scratch("torn.png"), torn), InvalidInput);
}

TEST(ImageGrid, CentresEachImageInItsCell) {
  const Pixel red = {255, 0, 0}, white = {255, 255, 255};
  const std::vector<Image> images = {Image(4, 2, red), Image(2, 2, red), Image(4, 2, red)};
  const Image grid = image_grid(images, 2, 1, white);
  ASSERT_EQ(grid.width, 9);
  ASSERT_EQ(grid.height, 5);
  const std::vector<std::string> expected = {"####..##.", "####..##.", ".........", "####.....", "####....."};
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 9; ++x) EXPECT_EQ(grid.at(x, y) == red, expected[y][x] == '#') << x << "," << y;
  }
  EXPECT_THROW(static_cast<void>(image_grid({}, 2, 1, white)), InvalidInput);
  EXPECT_THROW(static_cast<void>(image_grid(images, 0, 1, white)), InvalidInput);
  EXPECT_THROW(static_cast<void>(image_grid(images, 2, -1, white)), InvalidInput);
}

}  // namespace
}  // namespace shapelight
