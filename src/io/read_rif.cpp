#include "io/range_blocks.hpp"

/// RIF range images: lines about the scan, a line "|", "float ascii R C", then all X, all Y, all Z and all flags
/// (0 = valid, 1 = no data: the other way round than in OSU's text), row by row.
namespace shapelight::io {

Geometry read_rif(const Source& source) {
  TextScanner scanner = open_text(source, "rif");
  std::vector<std::string> comments;
  for (;;) {
    const std::optional<std::string_view> line = scanner.next_line();
    if (!line) scanner.fail("the file ends, expected a line '|' behind the header");
    if (scanner.next_token() == "|" && scanner.next_token().empty()) break;
    comments.emplace_back(*line);
  }
  if (scanner.need_token("'float ascii R C'") != "float" || scanner.next_token() != "ascii") {
    scanner.fail("only 'float ascii R C' is supported");
  }
  const std::int64_t rows = scanner.need_integer(scanner.next_token(), "the number of rows");
  const std::int64_t columns = scanner.need_integer(scanner.next_token(), "the number of columns");
  RangeBlocks blocks = make_range_blocks(scanner, rows, columns);
  read_coordinates(scanner, source.context, blocks);
  read_flags(scanner, source.context, 0, blocks);
  Geometry geometry = make_range_image(scanner, blocks);
  geometry.comments = std::move(comments);
  geometry.format = "rif";
  return geometry;
}

}  // namespace shapelight::io
