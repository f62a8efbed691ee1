#include "shapelight/render/image.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>

#include "io/output_file.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {

void write_png(const std::filesystem::path& path, const Image& image, bool overwrite) {
  const auto expected =
      static_cast<std::size_t>(std::max(0, image.width)) * static_cast<std::size_t>(std::max(0, image.height));
  if (expected == 0 || image.pixels.size() != expected) {
    throw InvalidInput(fmt::format("{}: an image of {} x {} holds {} pixels, expected width x height > 0",
                                   path.string(), image.width, image.height, image.pixels.size()));
  }
  io::OutputFile out(path, overwrite);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0) {
    throw WriteError(fmt::format("{}: cannot encode the PNG: {}", path.string(), header.message));
  }
  out.write(bytes.data(), size);
  out.commit();
}

void paste(Image& target, const Image& source, int left, int top) {
  for (int y = 0; y < source.height; ++y) std::copy_n(&source.at(0, y), source.width, &target.at(left, top + y));
}

Image image_grid(std::span<const Image> images, int columns, int gap, Pixel background) {
  if (images.empty() || columns < 1 || gap < 0) {
    throw InvalidInput(fmt::format("image grid: {} images in {} columns with gap {}, expected >= 1, >= 1 and >= 0",
                                   images.size(), columns, gap));
  }
  const int count = static_cast<int>(images.size());
  columns = std::min(columns, count);
  const int rows = (count + columns - 1) / columns;
  int cell_width = 0;
  int cell_height = 0;
  for (const Image& image : images) {
    cell_width = std::max(cell_width, image.width);
    cell_height = std::max(cell_height, image.height);
  }
  Image grid(columns * cell_width + (columns - 1) * gap, rows * cell_height + (rows - 1) * gap, background);
  for (int i = 0; i < count; ++i) {
    const Image& image = images[i];
    const int left = (i % columns) * (cell_width + gap) + (cell_width - image.width) / 2;
    const int top = (i / columns) * (cell_height + gap) + (cell_height - image.height) / 2;
    paste(grid, image, left, top);
  }
  return grid;
}

}  // namespace shapelight
