#include "io/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace shapelight::io {
namespace {

// Far above any real file; bounds the work that a hostile header can ask for.
constexpr std::size_t kMaxElements = 256;
constexpr std::size_t kMaxProperties = 4096;

constexpr std::array<std::pair<std::string_view, ScalarType>, 20> kTypeNames = {
    {{"char", ScalarType::Int8},      {"int8", ScalarType::Int8},      {"uchar", ScalarType::UInt8},
     {"uint8", ScalarType::UInt8},    {"short", ScalarType::Int16},    {"int16", ScalarType::Int16},
     {"ushort", ScalarType::UInt16},  {"uint16", ScalarType::UInt16},  {"int", ScalarType::Int32},
     {"int32", ScalarType::Int32},    {"uint", ScalarType::UInt32},    {"uint32", ScalarType::UInt32},
     {"long", ScalarType::Int64},     {"int64", ScalarType::Int64},    {"ulong", ScalarType::UInt64},
     {"uint64", ScalarType::UInt64},  {"float", ScalarType::Float32},  {"float32", ScalarType::Float32},
     {"double", ScalarType::Float64}, {"float64", ScalarType::Float64}}};

ScalarType need_type(TextScanner& scanner, std::string_view token) {
  const auto* found =
      std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const auto& known) { return known.first == token; });
  if (found == kTypeNames.end()) scanner.fail("unknown property type, expected char, uchar, ..., float or double");
  return found->second;
}

void read_format(TextScanner& scanner, PlyHeader& header) {
  const std::string_view encoding = scanner.next_token();
  header.ascii = encoding == "ascii";
  header.order = encoding == "binary_big_endian" ? std::endian::big : std::endian::little;
  if (!header.ascii && encoding != "binary_little_endian" && encoding != "binary_big_endian") {
    scanner.fail("unknown format, expected ascii, binary_little_endian or binary_big_endian");
  }
}

void read_element(TextScanner& scanner, PlyHeader& header) {
  if (header.elements.size() == kMaxElements) scanner.fail(fmt::format("more than {} elements", kMaxElements));
  PlyElement element;
  element.name = scanner.next_token();
  const std::int64_t count = scanner.need_integer(scanner.next_token(), "the number of elements");
  if (count < 0) scanner.fail(fmt::format("{} elements, expected 0 or more", count));
  element.count = static_cast<std::uint64_t>(count);
  const auto same = [&](const PlyElement& e) { return e.name == element.name; };
  if (std::any_of(header.elements.begin(), header.elements.end(), same)) {
    scanner.fail("the element occurs twice, expected once");
  }
  header.elements.push_back(std::move(element));
}

void read_property(TextScanner& scanner, PlyHeader& header, std::set<std::string>& names) {
  if (header.elements.empty()) scanner.fail("a property before any element");
  PlyElement& element = header.elements.back();
  if (element.properties.size() == kMaxProperties) scanner.fail(fmt::format("more than {} properties", kMaxProperties));
  PlyProperty property;
  std::string_view type = scanner.next_token();
  if (type == "list") {
    property.list_count_type = need_type(scanner, scanner.next_token());
    if (*property.list_count_type == ScalarType::Float32 || *property.list_count_type == ScalarType::Float64) {
      scanner.fail("a list counts in floating point, expected an integer type");
    }
    type = scanner.next_token();
  }
  property.type = need_type(scanner, type);
  property.name = scanner.next_token();
  if (property.name.empty()) scanner.fail("the property has no name");
  if (!names.insert(property.name).second) scanner.fail("the property occurs twice in its element, expected once");
  element.properties.push_back(std::move(property));
}

// The text after the keyword and one blank.
std::string rest_of(std::string_view line, std::size_t keyword) {
  return std::string(line.substr(std::min(line.size(), keyword + 1)));
}

// Grid size and viewpoint live in the geometry; everything else is kept as it stands.
void read_obj_info(TextScanner& scanner, std::string_view line, PlyHeader& header) {
  const std::string_view key = scanner.next_token();
  if (key == "num_cols" || key == "num_rows") {
    const std::int64_t value = scanner.need_integer(scanner.next_token(), key);
    if (value < 0 || value > std::int64_t{0xFFFFFFFF}) scanner.fail("grid size out of range, expected 0 .. 4294967295");
    (key == "num_cols" ? header.num_cols : header.num_rows) = static_cast<std::uint64_t>(value);
  } else if (key == "viewpoint") {
    std::array<double, 3> viewpoint{};
    for (double& v : viewpoint) v = scanner.need_double(scanner.next_token(), "three coordinates");
    header.viewpoint = viewpoint;
  } else {
    header.comments.emplace_back(line);
  }
}

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.list_count_type; });
}

std::size_t PlyElement::min_row_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += scalar_type_size(p.list_count_type.value_or(p.type));
  return bytes;
}

PlyHeader read_ply_header(TextScanner& scanner, std::string_view text) {
  PlyHeader header;
  const std::optional<std::string_view> magic = scanner.next_line();
  if (!magic || scanner.next_token() != "ply") scanner.fail("not a PLY file, expected the word ply");
  bool has_format = false;
  std::set<std::string> names;  // of the current element's properties
  for (;;) {
    const std::optional<std::string_view> line = scanner.next_line();
    if (!line) scanner.fail("the file ends within its header, expected end_header");
    const std::string_view keyword = scanner.next_token();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      read_format(scanner, header);
      has_format = true;
    } else if (keyword == "element") {
      read_element(scanner, header);
      names.clear();
    } else if (keyword == "property") {
      read_property(scanner, header, names);
    } else if (keyword == "comment") {
      header.comments.push_back(rest_of(*line, keyword.size()));
    } else if (keyword == "obj_info") {
      read_obj_info(scanner, *line, header);
    } else if (!keyword.empty()) {
      scanner.fail("unknown header line, expected format, element, property, comment, obj_info or end_header");
    }
  }
  if (!has_format) scanner.fail("the header has no format line");
  header.body_offset = scanner.byte_offset();
  // After a header of lone carriage returns, a newline belongs to the body although it looks like the rest of CRLF.
  const std::size_t first_end = magic->size();
  const bool lone_returns = text.substr(first_end, 1) == "\r" && text.substr(first_end, 2) != "\r\n";
  if (lone_returns && text.substr(header.body_offset - 2, 2) == "\r\n") --header.body_offset;
  return header;
}

}  // namespace shapelight::io
