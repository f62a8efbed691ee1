#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace shapelight::cli {

/// What people type for numbers. Each throws InvalidInput that names the option and what was expected.
/// 1200, 50k, 2M, 1.5M.
[[nodiscard]] std::uint64_t parse_count(std::string_view option, std::string_view text);
/// 0.1 or 10%.
[[nodiscard]] double parse_ratio(std::string_view option, std::string_view text);
/// In the file's units, or a percentage of the bounding-box diagonal: 0.5, 2%.
struct Length {
  double value = 0.0;
  bool of_diagonal = false;  ///< value is a share of the diagonal
  [[nodiscard]] double resolve(double diagonal) const { return of_diagonal ? value * diagonal : value; }
};
[[nodiscard]] Length parse_length(std::string_view option, std::string_view text);
/// 800M, 2G, 1.5GiB; plain numbers are bytes.
[[nodiscard]] std::uint64_t parse_bytes(std::string_view option, std::string_view text);
[[nodiscard]] double parse_number(std::string_view option, std::string_view text, std::string_view expected);

}  // namespace shapelight::cli
