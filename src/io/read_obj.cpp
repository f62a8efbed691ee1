#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/poll.hpp"
#include "io/narrow_columns.hpp"

/// Wavefront OBJ: point i is the i-th `v` line. Normals become columns when every vertex has exactly one; texture
/// coordinates stay with the corners. Materials, groups, curves and the rest are counted and left out.
namespace shapelight::io {
namespace {

struct Corner {
  Index vertex, texcoord, normal;  // kNoIndex where absent
};

// The `v`, `vt` or `vn` lines so far, and the largest index that was used ahead of its line.
struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::int64_t highest = -1;
  std::size_t highest_line = 0;
};

class ObjReader {
 public:
  explicit ObjReader(const Source& source) : source_(source), scanner_(open_text(source, "obj")) {}

  Geometry read() {
    while (const std::optional<std::string_view> line = scanner_.next_line()) {
      if (vertex_.count == 0 && line->starts_with('#')) read_comment(line->substr(1));
      poll(source_.context, scanner_.line_number());
      read_statement(next_token());
    }
    check_references();
    add_colors();
    add_normals();
    add_texcoords();
    if (!ignored_names_.empty()) {
      geometry_.warnings.push_back(
          fmt::format("{} statements were left out: {}", ignored_count_, fmt::join(ignored_names_, ", ")));
    }
    warn_count(geometry_, polygon_count_, "polygons with more than 3 corners were cut into triangles");
    geometry_.coordinate_type = narrowest_float(geometry_.positions);
    geometry_.format = "obj";
    return std::move(geometry_);
  }

 private:
  // The comments before the first vertex tell about the file, later ones about its statements.
  void read_comment(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    if (!text.empty()) geometry_.comments.emplace_back(text);
  }

  // The next token of the statement, which '\' continues on the next line; empty at its end or at a comment.
  std::string_view next_token() {
    for (;;) {
      std::string_view token = scanner_.next_token();
      if (token.starts_with('#')) return {};
      if (!token.ends_with('\\')) return token;
      if (!scanner_.next_token().empty()) scanner_.fail("text after '\\', expected the end of the line");
      token.remove_suffix(1);
      if (!scanner_.next_line() || !token.empty()) return token;
    }
  }

  void read_statement(std::string_view keyword) {
    if (keyword.empty()) return;
    if (keyword == "v") {
      read_vertex();
    } else if (keyword == "f") {
      read_face();
    } else if (keyword == "vn") {
      normals_.push_back(read_vector(3));
      ++normal_.count;
    } else if (keyword == "vt") {
      const Vec3 uv = read_vector(1);
      texcoords_.push_back({static_cast<float>(uv.x()), static_cast<float>(uv.y())});
      ++texcoord_.count;
    } else {
      constexpr std::size_t kMaxNames = 8;
      ++ignored_count_;
      if (ignored_names_.size() < kMaxNames) ignored_names_.insert(printable(keyword));
      while (!next_token().empty()) {
      }
    }
  }

  // Up to three numbers of which `needed` must be there; the others are 0.
  Vec3 read_vector(int needed) {
    Vec3 vector = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = next_token();
      if (token.empty() && axis >= needed) break;
      vector[axis] = scanner_.need_double(token, "a coordinate of 'vn' or 'vt'");
    }
    return vector;
  }

  void read_vertex() {
    std::array<double, 6> numbers{};
    std::size_t count = 0;
    for (std::string_view token = next_token(); !token.empty(); token = next_token()) {
      if (count == numbers.size()) scanner_.fail("more than 6 numbers in 'v', expected x y z [w] or x y z r g b");
      numbers[count++] = scanner_.need_double(token, "a coordinate or colour of 'v'");
    }
    if (count != 3 && count != 4 && count != 6) {
      scanner_.fail(fmt::format("{} numbers in 'v', expected x y z [w] or x y z r g b", count));
    }
    if (vertex_.count == kMaxPoints) scanner_.fail(fmt::format("expected at most {} vertices", kMaxPoints));
    const Vec3 point(numbers[0], numbers[1], numbers[2]);
    if (!point.allFinite()) non_finite_.emplace_back(static_cast<Index>(vertex_.count), scanner_.line_number());
    geometry_.positions.push_back(point);
    ++vertex_.count;
    if (count == 6) {
      for (std::size_t k = 0; k < 3; ++k) colors_[k].push_back(static_cast<float>(numbers[3 + k]));
    }
  }

  void read_face() {
    face_.clear();
    for (std::string_view token = next_token(); !token.empty(); token = next_token()) {
      face_.push_back(read_corner(token));
    }
    if (face_.size() < 3) scanner_.fail(fmt::format("a face with {} corners, expected at least 3", face_.size()));
    if (face_.size() > 3) ++polygon_count_;
    for (std::size_t k = 2; k < face_.size(); ++k) {
      const std::array<Corner, 3> corners = {face_[0], face_[k - 1], face_[k]};
      geometry_.triangles.push_back({corners[0].vertex, corners[1].vertex, corners[2].vertex});
      append_corners(corner_texcoords_, corners, &Corner::texcoord);
      append_corners(corner_normals_, corners, &Corner::normal);
    }
  }

  // Appends to a list that stays empty until a corner has the index.
  void append_corners(std::vector<Index>& list, const std::array<Corner, 3>& corners, Index Corner::*member) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index index = corners[k].*member;
      if (list.empty() && index == kNoIndex) continue;
      list.resize(3 * (geometry_.triangles.size() - 1) + k, kNoIndex);
      list.push_back(index);
    }
  }

  // "v", "v/vt", "v//vn" or "v/vt/vn".
  Corner read_corner(std::string_view token) {
    Corner corner{kNoIndex, kNoIndex, kNoIndex};
    const std::size_t slash = token.find('/');
    corner.vertex = read_index(token.substr(0, slash), vertex_);
    if (slash == std::string_view::npos) return corner;
    token.remove_prefix(slash + 1);
    const std::size_t second = token.find('/');
    if (second != 0 && !token.empty()) corner.texcoord = read_index(token.substr(0, second), texcoord_);
    if (second == std::string_view::npos) return corner;
    token.remove_prefix(second + 1);
    if (!token.empty()) corner.normal = read_index(token, normal_);
    return corner;
  }

  // From 1, or negative and relative to the lines so far. Lines that are still to come are checked at the end.
  Index read_index(std::string_view token, Element& element) {
    const auto count = static_cast<std::int64_t>(element.count);
    const std::int64_t number = scanner_.need_integer(token, element.name);
    const bool in_range = number > 0 ? number <= static_cast<std::int64_t>(kMaxPoints) : -number <= count;
    if (number == 0 || !in_range) {
      scanner_.fail(fmt::format("face has {} {}, expected 1 or more, or down to -{} counted from the last",
                                element.name, number, count));
    }
    const std::int64_t index = number > 0 ? number - 1 : count + number;
    if (index >= count && index > element.highest) {
      element.highest = index;
      element.highest_line = scanner_.line_number();
    }
    return static_cast<Index>(index);
  }

  void check_references() const {
    for (const Element* element : {&vertex_, &texcoord_, &normal_}) {
      if (element->highest >= static_cast<std::int64_t>(element->count)) {
        scanner_.fail_at(element->highest_line, fmt::format("face has {} {}, expected 1 .. {}", element->name,
                                                            element->highest + 1, element->count));
      }
    }
    if (vertex_.count == 0) scanner_.fail("the file ends without a vertex, expected 'v' lines");
    if (non_finite_.empty()) return;
    std::vector<bool> used(vertex_.count);
    for (const Triangle& triangle : geometry_.triangles) {
      for (const Index vertex : triangle) used[vertex] = true;
    }
    for (const auto& [vertex, line] : non_finite_) {
      if (used[vertex]) {
        scanner_.fail_at(line,
                         fmt::format("vertex {} belongs to a face and is not finite, expected numbers", vertex + 1));
      }
    }
  }

  void add_colors() {
    if (colors_[0].empty()) return;
    if (colors_[0].size() != vertex_.count) {
      warn_count(geometry_, colors_[0].size(), "vertex colours were left out: not every vertex has one");
      return;
    }
    constexpr std::array<const char*, 3> kNames = {"red", "green", "blue"};
    for (std::size_t k = 0; k < 3; ++k) geometry_.attributes.set({kNames[k], std::move(colors_[k])});
  }

  // A vertex that no face uses has the normal of its own number if there are as many normals as vertices.
  void add_normals() {
    if (normals_.empty()) return;
    std::vector<Index> normal_of(vertex_.count, kNoIndex);
    bool unique = true;
    for (std::size_t i = 0; i < corner_normals_.size(); ++i) {
      Index& chosen = normal_of[geometry_.triangles[i / 3][i % 3]];
      const Index normal = corner_normals_[i];
      if (normal == kNoIndex) continue;
      unique = unique && (chosen == kNoIndex || chosen == normal || normals_[chosen] == normals_[normal]);
      chosen = normal;
    }
    const bool by_number = normals_.size() == vertex_.count;
    for (std::size_t i = 0; i < normal_of.size(); ++i) {
      if (normal_of[i] == kNoIndex && by_number) normal_of[i] = static_cast<Index>(i);
      unique = unique && normal_of[i] != kNoIndex;
    }
    if (!unique) {
      warn_count(geometry_, normals_.size(), "normals were left out: not every vertex has exactly one");
      return;
    }
    constexpr std::array<const char*, 3> kNames = {"nx", "ny", "nz"};
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values(vertex_.count);
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = normals_[normal_of[i]][axis];
      geometry_.attributes.set(float_column(kNames[static_cast<std::size_t>(axis)], std::move(values)));
    }
  }

  void add_texcoords() {
    corner_texcoords_.resize(corner_texcoords_.empty() ? 0 : 3 * geometry_.triangles.size(), kNoIndex);
    const std::size_t missing =
        static_cast<std::size_t>(std::count(corner_texcoords_.begin(), corner_texcoords_.end(), kNoIndex));
    if (missing > 0 || (corner_texcoords_.empty() && !texcoords_.empty())) {
      warn_count(geometry_, texcoords_.size(), "texture coordinates were left out: not every face corner has one");
      return;
    }
    geometry_.corner_texcoords.reserve(corner_texcoords_.size());
    for (const Index index : corner_texcoords_) geometry_.corner_texcoords.push_back(texcoords_[index]);
  }

  const Source& source_;
  TextScanner scanner_;
  Geometry geometry_;
  Element vertex_{"vertex index"}, texcoord_{"texture index"}, normal_{"normal index"};
  std::vector<std::array<float, 2>> texcoords_;
  std::vector<Vec3> normals_;
  std::array<std::vector<float>, 3> colors_;
  std::vector<std::pair<Index, std::size_t>> non_finite_;  // vertex, line
  std::vector<Corner> face_;                               // scratch
  std::vector<Index> corner_texcoords_, corner_normals_;   // per triangle corner, empty when no face has any
  std::size_t polygon_count_ = 0;
  std::size_t ignored_count_ = 0;
  std::set<std::string> ignored_names_;
};

}  // namespace

Geometry read_obj(const Source& source) { return ObjReader(source).read(); }

}  // namespace shapelight::io
