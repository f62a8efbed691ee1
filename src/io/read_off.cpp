#include <fmt/format.h>

#include "core/poll.hpp"
#include "io/narrow_columns.hpp"

/// OFF with the prefixes N (normals), C (colours) and ST (texture coordinates, columns s and t) of Geomview. One
/// vertex and one face a line; comments anywhere. The colours of faces are left out.
namespace shapelight::io {
namespace {

class OffReader {
 public:
  explicit OffReader(const Source& source) : source_(source), scanner_(open_text(source, "off")) {}

  Geometry read() {
    if (!scanner_.next_data_line('#')) scanner_.fail("the file ends, expected 'OFF'");
    const std::string_view counts = read_header();
    read_counts(counts);
    read_vertices();
    read_faces();
    if (scanner_.next_data_line('#')) geometry_.warnings.emplace_back("text after the last face was left out");
    warn_count(geometry_, polygon_count_, "polygons with more than 3 corners were cut into triangles");
    warn_count(geometry_, face_color_count_, "face colours were left out");
    geometry_.coordinate_type = narrowest_float(geometry_.positions);
    geometry_.format = "off";
    return std::move(geometry_);
  }

 private:
  void need_line(std::size_t found, std::size_t expected, std::string_view what) {
    if (scanner_.next_data_line('#')) return;
    scanner_.fail(fmt::format("the file ends, expected {} {}, found {}", expected, what, found));
  }

  // [ST][C][N]OFF; returns the first count if it follows, with or without a blank.
  std::string_view read_header() {
    const std::string_view keyword = scanner_.next_token();
    std::string_view rest = keyword;
    const auto take = [&](std::string_view prefix) {
      const bool found = rest.starts_with(prefix);
      if (found) rest.remove_prefix(prefix.size());
      return found;
    };
    has_texcoords_ = take("ST");
    has_colors_ = take("C");
    has_normals_ = take("N");
    if (!take("OFF")) {
      scanner_.fail(fmt::format("'{}', expected OFF, COFF, NOFF, CNOFF or one of these after ST", printable(keyword)));
    }
    const std::string_view count = rest.empty() ? scanner_.next_token() : rest;
    if (count == "BINARY") scanner_.fail("binary OFF is not supported, expected text");
    return count;
  }

  void read_counts(std::string_view first) {
    if (first.empty()) {
      need_line(0, 1, "line with the numbers of vertices and faces");
      first = scanner_.next_token();
    }
    const std::int64_t vertices = scanner_.need_integer(first, "the number of vertices");
    const std::int64_t faces = scanner_.need_integer(scanner_.next_token(), "the number of faces");
    if (vertices < 1 || faces < 0)
      scanner_.fail(fmt::format("{} vertices and {} faces, expected some", vertices, faces));
    // The shortest lines are "0 0 0" and "3 0 1 2", each with a line end.
    constexpr std::int64_t kVertexSize = 6, kFaceSize = 8;
    const auto left = static_cast<std::int64_t>(scanner_.bytes_left()) + 1;
    if (vertices > left / kVertexSize || faces > (left - vertices * kVertexSize) / kFaceSize ||
        vertices > static_cast<std::int64_t>(kMaxPoints)) {
      scanner_.fail(fmt::format("{} vertices and {} faces do not fit into the {} bytes that follow", vertices, faces,
                                scanner_.bytes_left()));
    }
    vertex_count_ = static_cast<std::size_t>(vertices);
    face_count_ = static_cast<std::size_t>(faces);
  }

  void read_vertices() {
    geometry_.positions.reserve(vertex_count_);
    for (std::size_t i = 0; i < vertex_count_; ++i) {
      poll(source_.context, i);
      need_line(i, vertex_count_, "vertices");
      geometry_.positions.push_back(read_vector("x y z"));
      if (has_normals_) normals_.push_back(read_vector("nx ny nz"));
      std::vector<std::string_view>& rest = tokens_;
      rest.clear();
      for (auto token = scanner_.next_token(); !token.empty(); token = scanner_.next_token()) rest.push_back(token);
      if (has_texcoords_) take_texcoord(rest);
      if (has_colors_) take_color(rest);
      if (!rest.empty()) scanner_.fail(fmt::format("{} numbers more than the header tells", rest.size()));
    }
    add_columns();
  }

  Vec3 read_vector(std::string_view what) {
    Vec3 vector;
    for (int axis = 0; axis < 3; ++axis) vector[axis] = scanner_.need_double(scanner_.next_token(), what);
    return vector;
  }

  void take_texcoord(std::vector<std::string_view>& tokens) {
    if (tokens.size() < 2) scanner_.fail("the vertex ends, expected texture coordinates s t");
    for (std::size_t k = 0; k < 2; ++k) {
      texcoords_[k].push_back(scanner_.need_double(tokens[tokens.size() - 2 + k], "a texture coordinate"));
    }
    tokens.resize(tokens.size() - 2);
  }

  // r g b or r g b a, the same in every vertex; integers are within 0 .. 255, others within 0 .. 1.
  void take_color(std::vector<std::string_view>& tokens) {
    if (colors_.empty()) colors_.resize(tokens.size() == 4 ? 4 : 3);
    if (tokens.size() != colors_.size()) {
      scanner_.fail(fmt::format("{} colour numbers, expected {}", tokens.size(), colors_.size()));
    }
    for (std::size_t k = 0; k < tokens.size(); ++k) {
      colors_[k].push_back(scanner_.need_double(tokens[k], "a colour"));
      real_colors_ = real_colors_ || !parse_integer(tokens[k]);
    }
    tokens.clear();
  }

  void add_columns() {
    constexpr std::array<std::string_view, 3> kNormals = {"nx", "ny", "nz"};
    constexpr std::array<std::string_view, 4> kColors = {"red", "green", "blue", "alpha"};
    for (int axis = 0; has_normals_ && axis < 3; ++axis) {
      std::vector<double> values;
      values.reserve(normals_.size());
      for (const Vec3& normal : normals_) values.push_back(normal[axis]);
      geometry_.attributes.set(float_column(std::string(kNormals[static_cast<std::size_t>(axis)]), std::move(values)));
    }
    if (real_colors_) {
      for (std::size_t k = 0; k < colors_.size(); ++k) {
        geometry_.attributes.set({std::string(kColors[k]), std::vector<float>(colors_[k].begin(), colors_[k].end())});
      }
    } else {
      const std::size_t channels = colors_.size();
      set_colors(geometry_.attributes, std::span(kColors).first(channels), std::move(colors_));
    }
    if (!has_texcoords_) return;
    geometry_.attributes.set(float_column("s", std::move(texcoords_[0])));
    geometry_.attributes.set(float_column("t", std::move(texcoords_[1])));
  }

  void read_faces() {
    geometry_.triangles.reserve(face_count_);
    for (std::size_t i = 0; i < face_count_; ++i) {
      poll(source_.context, i);
      need_line(i, face_count_, "faces");
      const std::int64_t corners = scanner_.need_integer(scanner_.next_token(), "the number of corners");
      if (corners < 3) scanner_.fail(fmt::format("a face with {} corners, expected at least 3", corners));
      if (corners > 3) ++polygon_count_;
      const Index first = read_index();
      Index previous = read_index();
      for (std::int64_t k = 2; k < corners; ++k) {
        const Index next = read_index();
        geometry_.triangles.push_back({first, previous, next});
        previous = next;
      }
      if (!scanner_.next_token().empty()) ++face_color_count_;
    }
  }

  Index read_index() {
    const std::int64_t index = scanner_.need_integer(scanner_.next_token(), "a vertex index");
    if (index < 0 || index >= static_cast<std::int64_t>(vertex_count_)) {
      scanner_.fail(fmt::format("face has vertex index {}, expected 0 .. {}", index, vertex_count_ - 1));
    }
    if (!geometry_.positions[static_cast<std::size_t>(index)].allFinite()) {
      scanner_.fail(fmt::format("vertex {} of a face is not finite, expected numbers", index));
    }
    return static_cast<Index>(index);
  }

  const Source& source_;
  TextScanner scanner_;
  Geometry geometry_;
  bool has_normals_ = false, has_colors_ = false, has_texcoords_ = false, real_colors_ = false;
  std::size_t vertex_count_ = 0, face_count_ = 0;
  std::size_t polygon_count_ = 0, face_color_count_ = 0;
  std::vector<std::string_view> tokens_;  // scratch
  std::vector<Vec3> normals_;
  std::vector<std::vector<double>> colors_;
  std::array<std::vector<double>, 2> texcoords_;
};

}  // namespace

Geometry read_off(const Source& source) { return OffReader(source).read(); }

}  // namespace shapelight::io
