#include "io/pcd_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>

#include "shapelight/core/types.hpp"

namespace shapelight::io {
namespace {

constexpr std::size_t kMaxValuesPerPoint = 4096;  // the largest known descriptor has 1,980

// The header's lines may come in any order, so types are put together when all are there.
struct RawFields {
  std::vector<std::string> names;
  std::vector<std::string> sizes, types, counts;
};

std::vector<std::string> rest_of_line(TextScanner& scanner) {
  std::vector<std::string> words;
  for (std::string_view word = scanner.next_token(); !word.empty(); word = scanner.next_token()) {
    if (words.size() == kMaxValuesPerPoint) scanner.fail(fmt::format("more than {} fields", kMaxValuesPerPoint));
    words.emplace_back(word);
  }
  return words;
}

std::uint64_t need_count(TextScanner& scanner, std::string_view token, std::string_view what) {
  const std::int64_t value = scanner.need_integer(token, what);
  if (value < 0) scanner.fail(fmt::format("{} is {}, expected 0 or more", what, value));
  return static_cast<std::uint64_t>(value);
}

std::optional<ScalarType> field_type(std::string_view kind, std::int64_t size) {
  static constexpr std::array<ScalarType, 4> kSigned = {ScalarType::Int8, ScalarType::Int16, ScalarType::Int32,
                                                        ScalarType::Int64};
  static constexpr std::array<ScalarType, 4> kUnsigned = {ScalarType::UInt8, ScalarType::UInt16, ScalarType::UInt32,
                                                          ScalarType::UInt64};
  if (size != 1 && size != 2 && size != 4 && size != 8) return std::nullopt;
  const std::size_t power = size == 1 ? 0 : size == 2 ? 1 : size == 4 ? 2 : 3;
  if (kind == "I" || kind == "i") return kSigned[power];
  if (kind == "U" || kind == "u") return kUnsigned[power];
  if ((kind == "F" || kind == "f") && size >= 4) return size == 4 ? ScalarType::Float32 : ScalarType::Float64;
  return std::nullopt;
}

// Coordinates in capitals are taken for coordinates, normals get the names they have elsewhere.
std::string common_name(const std::string& name) {
  if (name == "X") return "x";
  if (name == "Y") return "y";
  if (name == "Z") return "z";
  if (name == "normal_x") return "nx";
  if (name == "normal_y") return "ny";
  if (name == "normal_z") return "nz";
  return name;
}

std::vector<PcdField> make_fields(TextScanner& scanner, const RawFields& raw) {
  const std::size_t n = raw.names.size();
  if (n == 0) scanner.fail("the header has no FIELDS");
  if (raw.sizes.size() != n || raw.types.size() != n || (!raw.counts.empty() && raw.counts.size() != n)) {
    scanner.fail(fmt::format("{} FIELDS with {} SIZE, {} TYPE, {} COUNT, expected as many of each", n, raw.sizes.size(),
                             raw.types.size(), raw.counts.size()));
  }
  std::vector<PcdField> fields;
  std::set<std::string> names;
  std::size_t num_values = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::optional<ScalarType> type = field_type(raw.types[i], scanner.need_integer(raw.sizes[i], "SIZE"));
    if (!type)
      scanner.fail(fmt::format("field {} has an unknown SIZE and TYPE, expected I or U of 1, 2, 4, 8 or F of 4, 8", i));
    const std::uint64_t count = raw.counts.empty() ? 1 : need_count(scanner, raw.counts[i], "COUNT");
    if (count < 1 || count > kMaxValuesPerPoint || (num_values += count) > kMaxValuesPerPoint) {
      scanner.fail(fmt::format("COUNT of field {} is {}, expected 1 .. {} in all", i, count, kMaxValuesPerPoint));
    }
    fields.push_back({common_name(raw.names[i]), *type, count});
    if (!fields.back().is_padding() && !names.insert(fields.back().name).second) {
      scanner.fail(fmt::format("field {} has the name of an earlier one, expected unique names", i));
    }
  }
  return fields;
}

PcdEncoding need_encoding(TextScanner& scanner) {
  const std::string_view word = scanner.next_token();
  if (word == "ascii") return PcdEncoding::Ascii;
  if (word == "binary") return PcdEncoding::Binary;
  if (word == "binary_compressed") return PcdEncoding::Compressed;
  scanner.fail("unknown DATA, expected ascii, binary or binary_compressed");
}

// WIDTH and HEIGHT are younger than POINTS; either may be missing.
void settle_size(TextScanner& scanner, PcdHeader& header, bool has_width, bool has_points) {
  if (!has_width && !has_points) scanner.fail("the header has neither WIDTH nor POINTS");
  if (!has_width) header.width = header.points;
  if (header.width > kMaxPoints || header.height > kMaxPoints ||
      (header.height != 0 && header.width > kMaxPoints / header.height)) {
    scanner.fail(fmt::format("{} x {} points, expected at most {}", header.width, header.height, kMaxPoints));
  }
  const std::uint64_t product = header.width * header.height;
  if (!has_points) header.points = product;
  if (header.points != product) {
    scanner.fail(fmt::format("POINTS is {}, expected WIDTH x HEIGHT = {}", header.points, product));
  }
  if (header.points == 0) scanner.fail("0 points, expected at least one");
}

}  // namespace

std::size_t PcdHeader::values_per_point() const {
  std::size_t values = 0;
  for (const PcdField& f : fields) values += f.count;
  return values;
}

std::size_t PcdHeader::bytes_per_point() const {
  std::size_t bytes = 0;
  for (const PcdField& f : fields) bytes += f.bytes();
  return bytes;
}

PcdHeader read_pcd_header(TextScanner& scanner) {
  PcdHeader header;
  RawFields raw;
  bool has_width = false, has_points = false;
  for (;;) {
    const std::optional<std::string_view> line = scanner.next_line();
    if (!line) scanner.fail("the file ends within its header, expected DATA");
    if (line->starts_with('#')) {
      if (line->find("Point Cloud Data file format") == std::string_view::npos) {
        header.comments.emplace_back(line->substr(line->starts_with("# ") ? 2 : 1));
      }
      continue;
    }
    const std::string_view key = scanner.next_token();
    if (key == "FIELDS" || key == "COLUMNS") {
      raw.names = rest_of_line(scanner);
    } else if (key == "SIZE") {
      raw.sizes = rest_of_line(scanner);
    } else if (key == "TYPE") {
      raw.types = rest_of_line(scanner);
    } else if (key == "COUNT") {
      raw.counts = rest_of_line(scanner);
    } else if (key == "WIDTH") {
      header.width = need_count(scanner, scanner.next_token(), "WIDTH");
      has_width = true;
    } else if (key == "HEIGHT") {
      header.height = need_count(scanner, scanner.next_token(), "HEIGHT");
    } else if (key == "POINTS") {
      header.points = need_count(scanner, scanner.next_token(), "POINTS");
      has_points = true;
    } else if (key == "VIEWPOINT") {
      for (double& v : header.viewpoint) v = scanner.need_double(scanner.next_token(), "VIEWPOINT of 7 numbers");
    } else if (key == "DATA") {
      header.encoding = need_encoding(scanner);
      break;
    } else if (!key.empty() && key != "VERSION") {
      scanner.fail(
          "unknown header line, expected VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA");
    }
  }
  header.fields = make_fields(scanner, raw);
  settle_size(scanner, header, has_width, has_points);
  return header;
}

}  // namespace shapelight::io
