#include "io/text_scanner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "shapelight/core/error.hpp"

namespace shapelight::io {
namespace {

// Microsoft's spellings of not-a-number and infinity: "1.#IND00", "-1.#QNAN", "1.#INF".
std::optional<double> parse_special(std::string_view token) {
  const bool negative = token.starts_with('-');
  const std::size_t mark = token.find('#');
  if (mark == std::string_view::npos) return std::nullopt;
  const std::string_view word = token.substr(mark + 1);
  if (word.starts_with("INF")) {
    return negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  }
  if (word.starts_with("IND") || word.starts_with("QNAN") || word.starts_with("SNAN")) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return std::nullopt;
}

}  // namespace

std::string printable(std::string_view token) {
  std::string shown(token.substr(0, 32));
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < 32 || c > 126; }, '?');
  return token.size() > 32 ? shown + "..." : shown;
}

std::optional<double> parse_double(std::string_view token) {
  if (token.starts_with('+')) token.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (end != token.data() + token.size() || token.empty()) return parse_special(token);
  if (error == std::errc::result_out_of_range) {
    // Too small becomes zero, too large infinity, as strtod has it; from_chars leaves the value alone.
    const bool tiny = token.find("e-") != std::string_view::npos || token.find("E-") != std::string_view::npos;
    const double sign = token.starts_with('-') ? -1.0 : 1.0;
    return sign * (tiny ? 0.0 : std::numeric_limits<double>::infinity());
  }
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<std::int64_t> parse_integer(std::string_view token) {
  if (token.starts_with('+')) token.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || end != token.data() + token.size()) return std::nullopt;
  return value;
}

std::optional<std::string_view> TextScanner::next_line() {
  if (position_ >= text_.size()) return std::nullopt;
  if (newline_ < position_) newline_ = text_.find('\n', position_);
  std::string_view line = text_.substr(position_, newline_ - position_);
  line = line.substr(0, line.find('\r'));
  position_ += line.size();
  if (position_ < text_.size()) position_ += text_.substr(position_, 2) == "\r\n" ? 2 : 1;
  ++line_number_;
  rest_ = line;
  return line;
}

std::optional<std::string_view> TextScanner::next_data_line(char comment) {
  while (const std::optional<std::string_view> line = next_line()) {
    rest_ = line->substr(0, line->find(comment));
    if (rest_.find_first_not_of(" \t") != std::string_view::npos) return rest_;
  }
  return std::nullopt;
}

std::string_view TextScanner::next_token(char separator) {
  const auto is_blank = [&](char c) { return c == ' ' || c == '\t' || c == separator; };
  std::size_t begin = 0;
  while (begin < rest_.size() && is_blank(rest_[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest_.size() && !is_blank(rest_[end])) ++end;
  const std::string_view token = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return token;
}

std::string_view TextScanner::need_token(std::string_view what) {
  for (;;) {
    const std::string_view token = next_token();
    if (!token.empty()) return token;
    if (!next_line()) fail(fmt::format("the file ends, expected {}", what));
  }
}

double TextScanner::need_double(std::string_view token, std::string_view what) const {
  const std::optional<double> value = parse_double(token);
  if (!value) fail(fmt::format("'{}' is not a number, expected {}", printable(token), what));
  return *value;
}

std::int64_t TextScanner::need_integer(std::string_view token, std::string_view what) const {
  const std::optional<std::int64_t> value = parse_integer(token);
  if (!value) fail(fmt::format("'{}' is not an integer, expected {}", printable(token), what));
  return *value;
}

void TextScanner::fail_at(std::size_t line_number, std::string_view message) const {
  throw FormatError(fmt::format("{}: {}: line {}: {}", format_, path_, line_number, message));
}

}  // namespace shapelight::io
