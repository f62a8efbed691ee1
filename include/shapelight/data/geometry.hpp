#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shapelight/core/types.hpp"
#include "shapelight/data/attributes.hpp"

namespace shapelight {

enum class GeometryKind : std::uint8_t { Mesh, RangeImage, Cloud };
[[nodiscard]] std::string_view geometry_kind_name(GeometryKind kind);  ///< "mesh", "range_image", "cloud"

/// Pixels of a range image. pixel[row * width + column] is the index of its point, kNoIndex where nothing was seen.
struct RangeGrid {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<Index> pixel;
};

/// What a LAS file says beside its points; kept so that writing it back loses nothing.
struct LasInfo {
  std::array<double, 3> scale{};   ///< [file units per step]
  std::array<double, 3> offset{};  ///< [file units]
  std::uint8_t point_format = 0;   ///< 0 .. 10
  std::vector<std::byte> header;   ///< the public header block, as read
  std::vector<std::byte> vlrs;     ///< all variable length records before the points, as read
};

/// Points, and whatever of triangles and pixels the input has: the one thing that readers return and writers take.
/// Indices are the input file's own, so point i is the i-th point of the file.
struct Geometry {
  std::vector<Vec3> positions;  ///< [input length unit], input frame, exact; non-finite where nothing was measured
  ScalarType coordinate_type = ScalarType::Float64;  ///< type the coordinates had in the file: Float32 or Float64
  AttributeTable attributes;                         ///< per point
  std::vector<Triangle> triangles;  ///< empty unless a mesh; polygons were cut into triangles on reading
  AttributeTable triangle_attributes;
  std::vector<std::array<float, 2>> corner_texcoords;  ///< (u, v) per triangle corner: empty or 3 x triangles
  std::optional<RangeGrid> grid;
  std::optional<Vec3> viewpoint;      ///< position of the sensor in the input frame, when known
  std::vector<std::string> comments;  ///< free text of the file, without line ends
  std::shared_ptr<const LasInfo> las;
  std::vector<std::string> warnings;  ///< odd but usable things met while reading, for people
  std::string format;                 ///< of the file: "ply", "las", ...

  [[nodiscard]] GeometryKind kind() const;
  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

/// What algorithms read: the arrays of a Geometry, or those of another library, taken as they are. Somebody else holds
/// them and must outlive the view.
struct GeometryView {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const RangeGrid* grid = nullptr;
  std::optional<Vec3> viewpoint;
  const Geometry* whole = nullptr;  ///< where attributes are, when there are any

  GeometryView() = default;
  GeometryView(const Geometry& geometry);
  [[nodiscard]] GeometryKind kind() const;
  [[nodiscard]] std::size_t size() const { return positions.size(); }
  /// The geometry that this is a view of; an empty one for plain arrays.
  [[nodiscard]] const Geometry& rest() const;
};
[[nodiscard]] std::vector<GeometryView> views_of(std::span<const Geometry> geometries);

/// The points at `indices` in that order, with their attributes; triangles and pixels are left behind.
[[nodiscard]] Geometry select_points(const GeometryView& geometry, std::span<const Index> indices);

/// Moves a geometry: positions, viewpoint, and the normals among the attributes (nx, ny, nz, of points and triangles).
void transform_geometry(Geometry& geometry, const RigidTransform& T_new_old);

/// Axis-aligned box of the finite points.
struct BoundingBox {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
  [[nodiscard]] Vec3 center() const { return 0.5 * (min + max); }
  [[nodiscard]] double diagonal() const { return (max - min).norm(); }
};
[[nodiscard]] BoundingBox bounding_box(std::span<const Vec3> positions);

}  // namespace shapelight
