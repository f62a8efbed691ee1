#include "io/range_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/poll.hpp"

namespace shapelight::io {

RangeBlocks make_range_blocks(const TextScanner& scanner, std::int64_t rows, std::int64_t columns) {
  constexpr std::int64_t kPixelSize = 8;  // four times one digit and a blank
  const auto left = static_cast<std::int64_t>(scanner.bytes_left()) + 1;
  const std::int64_t most = std::min(left / kPixelSize, static_cast<std::int64_t>(kMaxPoints));
  if (rows < 1 || columns < 1 || rows > most / columns) {
    scanner.fail(fmt::format("{} rows of {} pixels, expected as many as the {} bytes that follow can hold", rows,
                             columns, scanner.bytes_left()));
  }
  return {static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), {}, {}};
}

void read_flags(TextScanner& scanner, const RunContext& context, std::int64_t valid_flag, RangeBlocks& blocks) {
  const std::size_t count = std::size_t{blocks.width} * blocks.height;
  blocks.valid.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    poll(context, i);
    const std::int64_t flag = scanner.need_integer(scanner.need_token("the flags of all pixels"), "a flag 0 or 1");
    if (flag != 0 && flag != 1) scanner.fail(fmt::format("flag {} of pixel {}, expected 0 or 1", flag, i));
    blocks.valid[i] = flag == valid_flag;
  }
}

void read_coordinates(TextScanner& scanner, const RunContext& context, RangeBlocks& blocks) {
  const std::size_t count = std::size_t{blocks.width} * blocks.height;
  for (std::vector<double>& values : blocks.coordinates) {
    values.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      poll(context, i);
      values[i] = scanner.need_double(scanner.need_token("X, Y and Z of all pixels"), "a coordinate");
    }
  }
}

Geometry make_range_image(TextScanner& scanner, const RangeBlocks& blocks) {
  if (!scanner.next_token().empty() || scanner.next_data_line('\0')) {
    scanner.fail("text behind the last block, expected the end of the file");
  }
  Geometry geometry;
  RangeGrid grid{blocks.width, blocks.height, std::vector<Index>(blocks.valid.size(), kNoIndex)};
  for (std::size_t i = 0; i < blocks.valid.size(); ++i) {
    if (!blocks.valid[i]) continue;
    const Vec3 point(blocks.coordinates[0][i], blocks.coordinates[1][i], blocks.coordinates[2][i]);
    if (!point.allFinite()) {
      scanner.fail(fmt::format("the valid pixel in row {}, column {} is not finite, expected numbers", i / grid.width,
                               i % grid.width));
    }
    grid.pixel[i] = static_cast<Index>(geometry.size());
    geometry.positions.push_back(point);
  }
  if (geometry.positions.empty()) scanner.fail("no pixel is valid, expected at least one");
  geometry.coordinate_type = narrowest_float(geometry.positions);
  geometry.grid = std::move(grid);
  return geometry;
}

}  // namespace shapelight::io
