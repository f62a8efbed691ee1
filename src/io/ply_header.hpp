#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/text_scanner.hpp"
#include "shapelight/data/attributes.hpp"

namespace shapelight::io {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::Float32;      ///< of the value, or of the list's items
  std::optional<ScalarType> list_count_type;  ///< set for lists
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has_lists() const;
  [[nodiscard]] std::size_t min_row_bytes() const;  ///< [bytes] of a binary row whose lists are empty
};

struct PlyHeader {
  bool ascii = false;
  std::endian order = std::endian::little;  ///< of binary bodies
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  ///< obj_info lines keep that word in front
  std::uint64_t num_cols = 0;         ///< of a range_grid; 0 when not given
  std::uint64_t num_rows = 0;
  std::optional<std::array<double, 3>> viewpoint;  ///< our own obj_info line
  std::size_t body_offset = 0;                     ///< [bytes]
};

/// Reads up to and including the line end_header; the scanner then stands at the body.
[[nodiscard]] PlyHeader read_ply_header(TextScanner& scanner, std::string_view text);

}  // namespace shapelight::io
