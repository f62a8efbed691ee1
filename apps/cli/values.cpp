#include "values.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "shapelight/core/error.hpp"

namespace shapelight::cli {
namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view expected) {
  throw InvalidInput(fmt::format("--{}: '{}', expected {}", option, text, expected));
}

// Number and what follows it.
std::pair<double, std::string_view> split_number(std::string_view option, std::string_view text,
                                                 std::string_view expected) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) refuse(option, text, expected);
  return {value, text.substr(static_cast<std::size_t>(end - text.data()))};
}

}  // namespace

std::uint64_t parse_count(std::string_view option, std::string_view text) {
  constexpr std::string_view kExpected = "a number of points such as 1200, 50k or 2M";
  const auto [value, suffix] = split_number(option, text, kExpected);
  double scale = 0.0;
  if (suffix.empty()) scale = 1.0;
  if (suffix == "k" || suffix == "K") scale = 1e3;
  if (suffix == "M" || suffix == "m") scale = 1e6;
  const double count = value * scale;
  if (scale == 0.0 || count < 1.0 || count > 4e9 || std::abs(count - std::round(count)) > 1e-6) {
    refuse(option, text, kExpected);
  }
  return static_cast<std::uint64_t>(std::llround(count));
}

double parse_ratio(std::string_view option, std::string_view text) {
  constexpr std::string_view kExpected = "a share to keep, more than 0 and at most 1, such as 0.1 or 10%";
  const auto [value, suffix] = split_number(option, text, kExpected);
  const double ratio = suffix == "%" ? value / 100.0 : value;
  if (!(suffix.empty() || suffix == "%") || !(ratio > 0.0 && ratio <= 1.0)) refuse(option, text, kExpected);
  return ratio;
}

Length parse_length(std::string_view option, std::string_view text) {
  constexpr std::string_view kExpected = "a positive length in the file's units, or a share of the diagonal such as 2%";
  const auto [value, suffix] = split_number(option, text, kExpected);
  if (!(suffix.empty() || suffix == "%") || !(value > 0.0)) refuse(option, text, kExpected);
  return suffix == "%" ? Length{value / 100.0, true} : Length{value, false};
}

std::uint64_t parse_bytes(std::string_view option, std::string_view text) {
  constexpr std::string_view kExpected = "a size such as 800M or 2G";
  const auto [value, suffix] = split_number(option, text, kExpected);
  double scale = 0.0;
  if (suffix.empty() || suffix == "B") scale = 1.0;
  if (suffix == "K" || suffix == "k" || suffix == "KB" || suffix == "KiB") scale = 0x1p10;
  if (suffix == "M" || suffix == "m" || suffix == "MB" || suffix == "MiB") scale = 0x1p20;
  if (suffix == "G" || suffix == "g" || suffix == "GB" || suffix == "GiB") scale = 0x1p30;
  if (scale == 0.0 || value <= 0.0 || value * scale > 1e18) refuse(option, text, kExpected);
  return static_cast<std::uint64_t>(value * scale);
}

double parse_number(std::string_view option, std::string_view text, std::string_view expected) {
  const auto [value, suffix] = split_number(option, text, expected);
  if (!suffix.empty()) refuse(option, text, expected);
  return value;
}

}  // namespace shapelight::cli
