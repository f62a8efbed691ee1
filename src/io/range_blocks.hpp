#pragma once

#include "io/narrow_columns.hpp"

/// What the text formats of range images share: blocks of one number per pixel, row by row.
namespace shapelight::io {

struct RangeBlocks {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<bool> valid;
  std::array<std::vector<double>, 3> coordinates;
};

/// Checks the sizes against the bytes that follow: four blocks of at least two bytes a pixel. Throws FormatError.
[[nodiscard]] RangeBlocks make_range_blocks(const TextScanner& scanner, std::int64_t rows, std::int64_t columns);

/// Reads the flags (0 or 1) of all pixels; those equal to `valid_flag` are valid.
void read_flags(TextScanner& scanner, const RunContext& context, std::int64_t valid_flag, RangeBlocks& blocks);

/// Reads the blocks of all X, all Y and all Z.
void read_coordinates(TextScanner& scanner, const RunContext& context, RangeBlocks& blocks);

/// One point for each valid pixel, row by row. Throws FormatError on text behind the last block, on a valid pixel
/// that is not finite, and when no pixel is valid.
[[nodiscard]] Geometry make_range_image(TextScanner& scanner, const RangeBlocks& blocks);

}  // namespace shapelight::io
