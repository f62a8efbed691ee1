#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "core/poll.hpp"
#include "io/narrow_columns.hpp"
#include "io/point_welder.hpp"

/// STL, binary and ascii. It lists corners, not vertices: corners with exactly the same coordinates become one point,
/// and points are in the order of their first appearance. Facet normals follow from the corners and are not kept.
namespace shapelight::io {
namespace {

constexpr std::size_t kHeaderSize = 84;  // 80 bytes of anything and the number of facets
constexpr std::size_t kFacetSize = 50;   // normal, three corners, 16 bits of attributes

// STL is little-endian.
template <class T>
T load(const std::byte* bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < sizeof(T); ++k) value |= std::to_integer<std::uint32_t>(bytes[k]) << (8 * k);
  if constexpr (std::is_same_v<T, float>) {
    return std::bit_cast<float>(value);
  } else {
    return static_cast<T>(value);
  }
}

std::uint64_t binary_size(std::span<const std::byte> bytes) {
  return kHeaderSize + kFacetSize * std::uint64_t{load<std::uint32_t>(bytes.data() + kHeaderSize - 4)};
}

Geometry read_binary(const Source& source) {
  const std::span<const std::byte> bytes = source.file.bytes();
  const std::size_t count = (bytes.size() - kHeaderSize) / kFacetSize;
  if (3 * std::uint64_t{count} > kMaxPoints) fail_format(source, "stl", fmt::format("{} facets are too many", count));
  Geometry geometry;
  geometry.coordinate_type = ScalarType::Float32;
  geometry.triangles.reserve(count);
  PointWelder welder(geometry.positions);
  std::size_t with_attributes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    poll(source.context, i);
    const std::byte* facet = bytes.data() + kHeaderSize + i * kFacetSize;
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::byte* corner = facet + 12 + 12 * k;
      const Vec3 point(load<float>(corner), load<float>(corner + 4), load<float>(corner + 8));
      if (!point.allFinite()) {
        fail_format(
            source, "stl",
            fmt::format("byte {}: corner {} of facet {} is not finite, expected numbers", corner - bytes.data(), k, i));
      }
      triangle[k] = welder.add(point);
    }
    geometry.triangles.push_back(triangle);
    if (load<std::uint16_t>(facet + 48) != 0) ++with_attributes;
  }
  warn_count(geometry, with_attributes, "facets have attribute bytes (colours), which were left out");
  return geometry;
}

class AsciiReader {
 public:
  explicit AsciiReader(const Source& source) : source_(source), scanner_(open_text(source, "stl")) {}

  Geometry read() {
    PointWelder welder(geometry_.positions);
    bool in_solid = false;
    while (scanner_.next_line()) {
      poll(source_.context, scanner_.line_number());
      const std::string keyword = lower_case(scanner_.next_token());
      if (keyword == "vertex") {
        read_corner(welder);
      } else if (keyword == "outer") {
        in_loop_ = true;
        corner_count_ = 0;
      } else if (keyword == "endloop") {
        end_loop();
      } else if (keyword == "solid" || keyword == "endsolid") {
        if (in_loop_) scanner_.fail(fmt::format("'{}' inside a facet, expected 'endloop'", keyword));
        in_solid = keyword == "solid";
      } else if (!keyword.empty() && keyword != "facet" && keyword != "endfacet") {
        scanner_.fail(fmt::format("'{}', expected solid, facet, outer, vertex, endloop, endfacet or endsolid",
                                  printable(keyword)));
      }
    }
    if (in_solid) scanner_.fail("the file ends, expected 'endsolid'");
    geometry_.coordinate_type = narrowest_float(geometry_.positions);
    return std::move(geometry_);
  }

 private:
  void read_corner(PointWelder& welder) {
    if (!in_loop_ || corner_count_ == 3) scanner_.fail("a vertex, expected 3 in each 'outer loop'");
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = scanner_.need_double(scanner_.next_token(), "x y z");
    if (!point.allFinite()) scanner_.fail("the vertex is not finite, expected numbers");
    triangle_[corner_count_++] = welder.add(point);
  }

  void end_loop() {
    if (!in_loop_ || corner_count_ != 3)
      scanner_.fail(fmt::format("a facet with {} corners, expected 3", corner_count_));
    geometry_.triangles.push_back(triangle_);
    in_loop_ = false;
  }

  const Source& source_;
  TextScanner scanner_;
  Geometry geometry_;
  Triangle triangle_{};
  std::size_t corner_count_ = 0;
  bool in_loop_ = false;
};

// By size, since binary headers too may start with "solid".
bool is_binary(const Source& source) {
  const std::span<const std::byte> bytes = source.file.bytes();
  if (bytes.size() >= kHeaderSize && binary_size(bytes) == bytes.size()) return true;
  const std::string_view text = source.file.text();
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const bool solid = lower_case(text.substr(begin, 5)) == "solid" && text.find('\0') == std::string_view::npos;
  if (solid || bytes.empty()) return false;
  if (bytes.size() < kHeaderSize) {
    fail_format(source, "stl",
                fmt::format("{} bytes, expected 'solid' or at least {} bytes", bytes.size(), kHeaderSize));
  }
  fail_format(source, "stl",
              fmt::format("byte 80: the number of facets asks for {} bytes, the file has {}", binary_size(bytes),
                          bytes.size()));
}

}  // namespace

Geometry read_stl(const Source& source) {
  Geometry geometry = is_binary(source) ? read_binary(source) : AsciiReader(source).read();
  if (geometry.triangles.empty()) fail_format(source, "stl", "no facet, expected at least one");
  geometry.format = "stl";
  return geometry;
}

}  // namespace shapelight::io
