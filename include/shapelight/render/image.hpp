#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace shapelight {

using Pixel = std::array<std::uint8_t, 3>;  ///< red, green, blue; sRGB

/// A picture; pixel (x, y) is pixels[y * width + x], the first row on top.
struct Image {
  Image() = default;
  Image(int image_width, int image_height, Pixel fill)
      : width(image_width),
        height(image_height),
        pixels(static_cast<std::size_t>(image_width) * static_cast<std::size_t>(image_height), fill) {}

  int width = 0;   ///< [pixels]
  int height = 0;  ///< [pixels]
  std::vector<Pixel> pixels;

  [[nodiscard]] Pixel& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  [[nodiscard]] const Pixel& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// Writes an 8-bit RGB PNG: to a temporary file that is then renamed, so the target is either old or complete. The
/// same image gives the same bytes.
/// Throws InvalidInput (no pixels, or their number is not width x height), WriteError (exists and overwrite is off,
/// ...).
void write_png(const std::filesystem::path& path, const Image& image, bool overwrite = false);

/// Copies `source` into `target` with its upper left pixel at (left, top). Pre: it fits.
void paste(Image& target, const Image& source, int left, int top);

/// Places images row by row in a grid of `columns`, each centred in a cell as large as the largest image.
/// Throws InvalidInput when there is none, or columns < 1, or gap < 0.
[[nodiscard]] Image image_grid(std::span<const Image> images, int columns, int gap, Pixel background);

}  // namespace shapelight
