#include <Eigen/Geometry>
#include <bit>
#include <limits>

#include "io/text_writer.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::io {
namespace {

// The unit normal; zero for a triangle without area, as the format asks for.
Vec3 facet_normal(const std::array<Vec3, 3>& corners) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double length = normal.norm();
  return length > 0.0 ? Vec3(normal / length) : Vec3::Zero();
}

std::array<Vec3, 3> corners_of(const Geometry& geometry, const Triangle& triangle) {
  return {geometry.positions[triangle[0]], geometry.positions[triangle[1]], geometry.positions[triangle[2]]};
}

void write_ascii(OutputFile& out, const Geometry& geometry) {
  TextWriter writer(out);
  writer.text("solid shapelight\n");
  for (const Triangle& triangle : geometry.triangles) {
    const std::array<Vec3, 3> corners = corners_of(geometry, triangle);
    writer.text("facet normal ");
    writer.point(facet_normal(corners), ScalarType::Float32);
    writer.text("\nouter loop\n");
    for (const Vec3& corner : corners) {
      writer.text("vertex ");
      writer.point(corner, geometry.coordinate_type);
      writer.text("\n");
    }
    writer.text("endloop\nendfacet");
    writer.end_line();
  }
  writer.text("endsolid shapelight\n");
  writer.finish();
}

void append(std::string& bytes, std::uint32_t value, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) bytes.push_back(static_cast<char>((value >> (8 * k)) & 0xff));
}

void append(std::string& bytes, const Vec3& point) {
  for (const double x : point) append(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(x)), 4);
}

void write_binary(OutputFile& out, const Geometry& geometry) {
  constexpr std::size_t kFull = 1 << 16;
  if (geometry.triangles.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw InvalidInput("stl: more triangles than its 32-bit count can tell");
  }
  std::string bytes = "binary stl written by shapelight";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(geometry.triangles.size()), 4);
  for (const Triangle& triangle : geometry.triangles) {
    const std::array<Vec3, 3> corners = corners_of(geometry, triangle);
    append(bytes, facet_normal(corners));
    for (const Vec3& corner : corners) append(bytes, corner);
    append(bytes, 0, 2);
    if (bytes.size() < kFull) continue;
    out.write(bytes);
    bytes.clear();
  }
  out.write(bytes);
}

}  // namespace

DroppedAttributes write_stl(OutputFile& out, const Geometry& geometry, const WriteOptions& options) {
  if (geometry.triangles.empty()) throw InvalidInput("stl: the geometry has no triangles, expected a mesh");
  options.ascii ? write_ascii(out, geometry) : write_binary(out, geometry);
  return left_out(geometry, {});
}

}  // namespace shapelight::io
