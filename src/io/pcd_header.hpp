#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/text_scanner.hpp"
#include "shapelight/data/attributes.hpp"

namespace shapelight::io {

enum class PcdEncoding : std::uint8_t { Ascii, Binary, Compressed };

struct PcdField {
  std::string name;
  ScalarType type = ScalarType::Float32;
  std::size_t count = 1;  ///< values per point

  [[nodiscard]] std::size_t bytes() const { return count * scalar_type_size(type); }
  [[nodiscard]] bool is_padding() const { return name == "_"; }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  std::uint64_t points = 0;
  std::array<double, 7> viewpoint = {0, 0, 0, 1, 0, 0, 0};  ///< tx ty tz, qw qx qy qz
  PcdEncoding encoding = PcdEncoding::Ascii;
  std::vector<std::string> comments;

  [[nodiscard]] std::size_t values_per_point() const;
  [[nodiscard]] std::size_t bytes_per_point() const;
};

/// Reads up to and including the line DATA; the scanner then stands at the points.
[[nodiscard]] PcdHeader read_pcd_header(TextScanner& scanner);

}  // namespace shapelight::io
