#include <fmt/format.h>

#include <algorithm>

#include "io/formats.hpp"
#include "io/ply_body.hpp"
#include "io/ply_header.hpp"
#include "io/text_columns.hpp"
#include "shapelight/core/error.hpp"

// Turk's Polygon File Format with the elements in use since: vertex, face, tristrips (VTK, Cyberware) and the
// range_grid of the Stanford scans. Elements may come in any order, so indices are checked when all are read.
namespace shapelight::io {
namespace {

struct Elements {
  std::optional<PlyRows> vertex, face, tristrips, range_grid;
};

class Assembler {
 public:
  Assembler(const Source& source, const PlyHeader& header) : source_(source), header_(header) {}

  Geometry build(Elements& elements, std::vector<std::string> warnings) {
    geometry_.warnings = std::move(warnings);
    geometry_.comments = header_.comments;
    if (header_.viewpoint) geometry_.viewpoint = Vec3(header_.viewpoint->data());
    if (!elements.vertex) fail("the header has no element vertex");
    set_vertices(*elements.vertex);
    if (elements.face) add_faces(*elements.face);
    if (elements.tristrips) add_strips(elements.tristrips->indices);
    if (elements.range_grid) set_grid(elements.range_grid->indices);
    return std::move(geometry_);
  }

 private:
  void set_vertices(PlyRows& rows) {
    if (!take_positions(rows.columns, geometry_)) fail("element vertex lacks a scalar property x, y or z");
    for (Column& column : rows.columns) geometry_.attributes.set(std::move(column));
  }

  // A polygon becomes a fan about its first corner; the face's scalars are repeated for each of its triangles.
  void add_faces(PlyRows& rows) {
    if (!rows.has_indices) {
      geometry_.warnings.emplace_back("element face has no list vertex_indices; faces skipped");
      return;
    }
    const bool has_texcoords = rows.texcoords.size() == rows.indices.size() && rows.indices.size() > 0;
    std::vector<Index> face_of_triangle;
    std::size_t num_polygons = 0, num_short = 0;
    for (std::size_t f = 0; f < rows.indices.size(); ++f) {
      const std::span<const Index> corners = rows.indices.row(f);
      check_indices(corners, "face", f);
      if (corners.size() < 3) ++num_short;
      if (corners.size() > 3) ++num_polygons;
      for (std::size_t i = 2; i < corners.size(); ++i) {
        geometry_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
        face_of_triangle.push_back(static_cast<Index>(f));
        if (has_texcoords) add_texcoords(rows.texcoords.row(f), corners.size(), i);
      }
    }
    for (Column& column : rows.columns) geometry_.triangle_attributes.set(column.gather(face_of_triangle));
    warn(num_polygons, "faces with more than 3 corners cut into triangles");
    warn(num_short, "faces with fewer than 3 corners skipped");
    warn(num_bad_texcoords_, "triangles without 2 texture coordinates per corner");
  }

  void add_texcoords(std::span<const float> uv, std::size_t num_corners, std::size_t i) {
    const bool complete = uv.size() == 2 * num_corners;
    if (!complete) ++num_bad_texcoords_;
    for (const std::size_t corner : {std::size_t{0}, i - 1, i}) {
      geometry_.corner_texcoords.push_back(complete ? std::array<float, 2>{uv[2 * corner], uv[2 * corner + 1]}
                                                    : std::array<float, 2>{});
    }
  }

  // Each index after the second makes a triangle with the two before it, every other one turned over; -1 starts anew.
  // Triangles that repeat a corner only steer the strip.
  void add_strips(const RowLists<Index>& strips) {
    for (std::size_t s = 0; s < strips.size(); ++s) {
      std::size_t length = 0;
      const std::span<const Index> items = strips.row(s);
      for (std::size_t i = 0; i < items.size(); ++i) {
        if (items[i] == kNoIndex) {
          length = 0;
          continue;
        }
        check_indices(items.subspan(i, 1), "tristrips", s);
        if (++length < 3) continue;
        Triangle triangle = {items[i - 2], items[i - 1], items[i]};
        if (length % 2 == 0) std::swap(triangle[0], triangle[1]);
        if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[0] != triangle[2]) {
          geometry_.triangles.push_back(triangle);
        }
      }
    }
  }

  void set_grid(const RowLists<Index>& cells) {
    if (header_.num_cols == 0 || header_.num_rows == 0 || header_.num_cols * header_.num_rows != cells.size()) {
      fail(fmt::format("range_grid has {} cells, expected obj_info num_cols x num_rows = {} x {}", cells.size(),
                       header_.num_cols, header_.num_rows));
    }
    RangeGrid grid{static_cast<std::uint32_t>(header_.num_cols), static_cast<std::uint32_t>(header_.num_rows), {}};
    grid.pixel.reserve(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::span<const Index> cell = cells.row(c);
      if (cell.size() > 1) fail(fmt::format("range_grid {}: {} vertex indices, expected 0 or 1", c, cell.size()));
      check_indices(cell, "range_grid", c);
      grid.pixel.push_back(cell.empty() ? kNoIndex : cell[0]);
    }
    geometry_.grid = std::move(grid);
  }

  void check_indices(std::span<const Index> indices, std::string_view element, std::size_t row) const {
    for (const Index i : indices) {
      if (i < geometry_.size()) continue;
      fail(fmt::format("element {} {}: vertex index {}, expected less than {} vertices", element, row,
                       i == kNoIndex ? "-1" : std::to_string(i), geometry_.size()));
    }
  }

  void warn(std::size_t count, std::string_view what) {
    if (count > 0) geometry_.warnings.push_back(fmt::format("{} {}", count, what));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(fmt::format("ply: {}: {}", source_.path.string(), what));
  }

  const Source& source_;
  const PlyHeader& header_;
  Geometry geometry_;
  std::size_t num_bad_texcoords_ = 0;
};

void check_header(const PlyHeader& header, const TextScanner& scanner) {
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex" && element.count == 0) scanner.fail("0 vertices, expected at least one");
    if (element.count > kMaxPoints && !element.properties.empty() && element.name == "vertex") {
      scanner.fail(fmt::format("{} vertices, expected at most {}", element.count, kMaxPoints));
    }
  }
}

}  // namespace

Geometry read_ply(const Source& source) {
  TextScanner scanner(source.file.text(), "ply", source.path.string());
  const PlyHeader header = read_ply_header(scanner, source.file.text());
  check_header(header, scanner);
  const std::unique_ptr<PlyBody> body = open_ply_body(source, header, scanner);
  Elements elements;
  std::vector<std::string> warnings;
  for (const PlyElement& element : header.elements) {
    std::optional<PlyRows>* known = element.name == "vertex"       ? &elements.vertex
                                    : element.name == "face"       ? &elements.face
                                    : element.name == "tristrips"  ? &elements.tristrips
                                    : element.name == "range_grid" ? &elements.range_grid
                                                                   : nullptr;
    if (known != nullptr) {
      *known = body->read(element, warnings);
    } else {
      body->skip(element);
      warnings.push_back(fmt::format("element {} with {} rows skipped", element.name, element.count));
    }
  }
  return Assembler(source, header).build(elements, std::move(warnings));
}

}  // namespace shapelight::io
