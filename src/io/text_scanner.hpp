#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace shapelight::io {

/// Walks over text line by line and token by token, knowing the line number for messages. Line ends may be LF, CRLF
/// or CR. Separators are blanks and, when asked for, one more character (a comma, a semicolon).
class TextScanner {
 public:
  /// `format` and `path` head every message: "ply: FILE: line 12: ...".
  TextScanner(std::string_view text, std::string format, std::string path)
      : text_(text), format_(std::move(format)), path_(std::move(path)), newline_(text.find('\n')) {}

  /// The next line without its end; nothing at the end of the text. Tokens are then taken from this line.
  std::optional<std::string_view> next_line();
  /// The next line that has a token, cut off at `comment`; nothing at the end of the text.
  std::optional<std::string_view> next_data_line(char comment);
  /// The next token of the current line; empty when none is left.
  std::string_view next_token(char separator = ' ');
  /// The next token of the current line or of later ones; throws FormatError "... ends, expected `what`".
  std::string_view need_token(std::string_view what);

  /// The token as a number. Accepts a leading '+', nan and inf in any case, and "1.#IND", "1.#QNAN", "1.#INF".
  /// Throws FormatError: "line N: 'abc' is not a number, expected `what`".
  double need_double(std::string_view token, std::string_view what) const;
  /// Throws also when the number does not fit.
  std::int64_t need_integer(std::string_view token, std::string_view what) const;

  [[nodiscard]] std::size_t line_number() const { return line_number_; }  ///< of the current line, from 1
  [[nodiscard]] std::size_t byte_offset() const { return position_; }     ///< of the line after the current one
  [[nodiscard]] std::size_t bytes_left() const { return text_.size() - position_; }  ///< after the current line
  /// Throws FormatError with the place and the message.
  [[noreturn]] void fail(std::string_view message) const { fail_at(line_number_, message); }
  [[noreturn]] void fail_at(std::size_t line_number, std::string_view message) const;

 private:
  std::string_view text_;
  std::string format_;
  std::string path_;
  std::size_t position_ = 0;
  std::size_t line_number_ = 0;
  std::size_t newline_;    // the next LF at or after position_; kept, so that text with CR ends is searched once
  std::string_view rest_;  // of the current line
};

/// `token` cut to a length fit for a message, with '?' for bytes that are not printable ASCII.
[[nodiscard]] std::string printable(std::string_view token);

/// Parses the whole of `token`; nothing when it is not a number. Locale-free.
[[nodiscard]] std::optional<double> parse_double(std::string_view token);
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view token);

}  // namespace shapelight::io
