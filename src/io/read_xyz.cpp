#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/poll.hpp"
#include "io/narrow_columns.hpp"

/// Points as columns of text: .xyz .txt .csv .pts .asc. The separator, a line of column names and the count that
/// begins a .pts file are recognised; without names the meaning of the columns follows from their number.
namespace shapelight::io {
namespace {

using Names = std::vector<std::string>;

// The name that PLY uses, for those that others spell differently; any other name stays as it is.
std::string canonical_name(std::string_view name) {
  static const std::map<std::string, std::string, std::less<>> kNames = {
      {"x", "x"},
      {"y", "y"},
      {"z", "z"},
      {"nx", "nx"},
      {"ny", "ny"},
      {"nz", "nz"},
      {"normal_x", "nx"},
      {"normal_y", "ny"},
      {"normal_z", "nz"},
      {"normalx", "nx"},
      {"normaly", "ny"},
      {"normalz", "nz"},
      {"red", "red"},
      {"green", "green"},
      {"blue", "blue"},
      {"alpha", "alpha"},
      {"r", "red"},
      {"g", "green"},
      {"b", "blue"},
      {"a", "alpha"},
      {"i", "intensity"},
      {"intensity", "intensity"},
      {"gpstime", "gps_time"},
      {"gps_time", "gps_time"},
      {"classification", "classification"},
      {"returnnumber", "return_number"},
      {"numberofreturns", "number_of_returns"},
      {"pointsourceid", "point_source_id"},
      {"scananglerank", "scan_angle_rank"},
      {"userdata", "user_data"},
  };
  if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  const auto found = kNames.find(lower_case(name));
  return found == kNames.end() ? std::string(name) : found->second;
}

bool holds(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool has_xyz(const Names& names) { return holds(names, "x") && holds(names, "y") && holds(names, "z"); }

class XyzReader {
 public:
  explicit XyzReader(const Source& source) : source_(source), scanner_(open_text(source, "xyz")) {}

  Geometry read() {
    read_rows();
    if (row_count_ == 0) scanner_.fail("the file ends without a point, expected rows x y z");
    if (expected_rows_ && *expected_rows_ != static_cast<std::int64_t>(row_count_)) {
      scanner_.fail(fmt::format("the file ends after {} points, expected {}", row_count_, *expected_rows_));
    }
    if (names_.empty()) names_ = guess_names();
    return build();
  }

 private:
  void read_rows() {
    while (const std::optional<std::string_view> line = scanner_.next_line()) {
      poll(source_.context, scanner_.line_number());
      const std::size_t begin = line->find_first_not_of(" \t");
      if (begin == std::string_view::npos) continue;
      const std::string_view text = line->substr(begin);
      if (text.starts_with('#') || text.starts_with("//")) {
        if (row_count_ == 0) read_comment(text);
        continue;
      }
      if (columns_.empty() && read_heading(text)) continue;
      read_row();
    }
  }

  std::vector<std::string_view> tokens_of_line() {
    std::vector<std::string_view> tokens;
    for (auto token = scanner_.next_token(separator_); !token.empty(); token = scanner_.next_token(separator_)) {
      tokens.push_back(token);
    }
    return tokens;
  }

  void choose_separator(std::string_view text) {
    separator_ = text.find(';') != std::string_view::npos ? ';' : text.find(',') != std::string_view::npos ? ',' : ' ';
  }

  Names canonical_names(const std::vector<std::string_view>& tokens) const {
    Names names;
    for (const std::string_view token : tokens) {
      std::string name = canonical_name(token);
      if (holds(names, name)) scanner_.fail(fmt::format("column '{}' occurs twice, expected once", printable(token)));
      names.push_back(std::move(name));
    }
    return names;
  }

  // A comment right before the rows that names as many columns as they have, x, y and z among them, is the heading.
  void read_comment(std::string_view text) {
    const std::string_view words = text.substr(std::min(text.find_first_not_of("#/ \t"), text.size()));
    choose_separator(words);
    TextScanner scanner(words, "xyz", source_.path.string());
    scanner.next_line();
    Names names;
    for (auto token = scanner.next_token(separator_); !token.empty(); token = scanner.next_token(separator_)) {
      names.push_back(canonical_name(token));
    }
    if (has_xyz(names)) {
      comment_names_ = std::move(names);
    } else if (!words.empty()) {
      geometry_.comments.emplace_back(words);
    }
  }

  // The first line that is no comment: a count, names (both return true) or a row.
  bool read_heading(std::string_view text) {
    choose_separator(text);
    const TextScanner at_line_begin = scanner_;
    const std::vector<std::string_view> tokens = tokens_of_line();
    const bool first = names_.empty() && !expected_rows_;
    if (first && tokens.size() == 1 && parse_integer(tokens[0])) {
      expected_rows_ = parse_integer(tokens[0]);
      return true;
    }
    const bool words = std::none_of(tokens.begin(), tokens.end(), [](auto token) { return parse_double(token); });
    if (names_.empty() && words) {
      names_ = canonical_names(tokens);
      if (!has_xyz(names_)) scanner_.fail("the columns' names lack x, y or z, expected all three");
      return true;
    }
    start_columns(tokens.size());
    scanner_ = at_line_begin;
    return false;
  }

  void start_columns(std::size_t count) {
    if (count < 3) scanner_.fail(fmt::format("{} columns, expected at least x y z", count));
    if (!names_.empty() && names_.size() != count) {
      scanner_.fail(fmt::format("{} columns, expected the {} that are named", count, names_.size()));
    }
    if (names_.empty() && comment_names_.size() == count) {
      const std::vector<std::string_view> views(comment_names_.begin(), comment_names_.end());
      names_ = canonical_names(views);
    }
    columns_.resize(count);
  }

  void read_row() {
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const std::string_view token = scanner_.next_token(separator_);
      if (token.empty()) scanner_.fail(fmt::format("{} columns, expected {}", k, columns_.size()));
      columns_[k].push_back(scanner_.need_double(token, "a number in every column"));
    }
    const std::size_t surplus = tokens_of_line().size();
    if (surplus > 0) scanner_.fail(fmt::format("{} columns, expected {}", columns_.size() + surplus, columns_.size()));
    if (row_count_ == kMaxPoints) scanner_.fail(fmt::format("expected at most {} points", kMaxPoints));
    ++row_count_;
  }

  Names guess_names() const {
    switch (columns_.size()) {
      case 3:
        return {"x", "y", "z"};
      case 4:
        return {"x", "y", "z", "intensity"};
      case 6:
        return unit_vectors() ? Names{"x", "y", "z", "nx", "ny", "nz"} : Names{"x", "y", "z", "red", "green", "blue"};
      case 7:
        return {"x", "y", "z", "intensity", "red", "green", "blue"};
      default:
        break;
    }
    Names names = {"x", "y", "z"};
    for (std::size_t k = 3; k < columns_.size(); ++k) names.push_back(fmt::format("scalar_{}", k));
    return names;
  }

  // Are columns 3 to 5 unit vectors, within the rounding that text has seen?
  bool unit_vectors() const {
    for (std::size_t i = 0; i < row_count_; ++i) {
      const double length = Vec3(columns_[3][i], columns_[4][i], columns_[5][i]).norm();
      if (!(std::abs(length - 1.0) <= 0.01)) return false;
    }
    return true;
  }

  const std::vector<double>* column(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? nullptr : &columns_[static_cast<std::size_t>(found - names_.begin())];
  }

  Geometry build() {
    const auto &x = *column("x"), &y = *column("y"), &z = *column("z");
    geometry_.positions.resize(row_count_);
    for (std::size_t i = 0; i < row_count_; ++i) geometry_.positions[i] = Vec3(x[i], y[i], z[i]);
    geometry_.coordinate_type = narrowest_float(geometry_.positions);
    constexpr std::array<std::string_view, 4> kColors = {"red", "green", "blue", "alpha"};
    std::vector<std::string_view> color_names;
    std::vector<std::vector<double>> colors;
    for (const std::string_view name : kColors) {
      if (const std::vector<double>* values = column(name)) {
        color_names.push_back(name);
        colors.push_back(*values);
      }
    }
    AttributeTable color_table;
    set_colors(color_table, color_names, std::move(colors));
    for (std::size_t k = 0; k < names_.size(); ++k) {
      const std::string& name = names_[k];
      if (name == "x" || name == "y" || name == "z") continue;
      const Column* color = color_table.find(name);
      geometry_.attributes.set(color != nullptr ? *color : float_column(name, std::move(columns_[k])));
    }
    geometry_.format = "xyz";
    return std::move(geometry_);
  }

  const Source& source_;
  TextScanner scanner_;
  Geometry geometry_;
  char separator_ = ' ';
  Names names_, comment_names_;
  std::optional<std::int64_t> expected_rows_;  // as a .pts file begins
  std::vector<std::vector<double>> columns_;
  std::size_t row_count_ = 0;
};

}  // namespace

Geometry read_xyz(const Source& source) { return XyzReader(source).read(); }

}  // namespace shapelight::io
