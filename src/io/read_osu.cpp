#include "io/range_blocks.hpp"

/// Range images of the Ohio State and Notre Dame collections (.abs): "R rows", "C columns", "pixels (flag X Y Z):",
/// then all flags (1 = valid), all X, all Y, all Z, row by row.
namespace shapelight::io {
namespace {

std::int64_t read_size(TextScanner& scanner, std::string_view word) {
  const std::int64_t size = scanner.need_integer(scanner.need_token(word), word);
  if (scanner.next_token() != word) scanner.fail("expected a number followed by '" + std::string(word) + "'");
  return size;
}

}  // namespace

Geometry read_osu(const Source& source) {
  TextScanner scanner = open_text(source, "osu");
  const std::int64_t rows = read_size(scanner, "rows");
  const std::int64_t columns = read_size(scanner, "columns");
  if (scanner.need_token("'pixels (flag X Y Z):'") != "pixels") scanner.fail("expected 'pixels (flag X Y Z):'");
  while (!scanner.next_token().empty()) {
  }
  RangeBlocks blocks = make_range_blocks(scanner, rows, columns);
  read_flags(scanner, source.context, 1, blocks);
  read_coordinates(scanner, source.context, blocks);
  Geometry geometry = make_range_image(scanner, blocks);
  geometry.format = "osu";
  return geometry;
}

}  // namespace shapelight::io
