#include "geometry.hpp"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bindings.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::python {
namespace {

using AnyVector = nb::ndarray<nb::ro, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using PixelArray = nb::ndarray<const Index, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using TexcoordArray = nb::ndarray<const float, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

template <std::size_t... Is>
Column column_of(std::string name, const AnyVector& values, std::index_sequence<Is...>) {
  Column column{std::move(name), {}};
  bool known = false;
  const auto take = [&]<std::size_t I>() {
    using Values = std::variant_alternative_t<I, Column::Values>;
    using Scalar = typename Values::value_type;
    if (values.dtype() != nb::dtype<Scalar>()) return;
    const auto* data = static_cast<const Scalar*>(values.data());
    column.values = Values(data, data + values.shape(0));
    known = true;
  };
  (take.template operator()<Is>(), ...);
  if (!known) throw InvalidInput(fmt::format("attribute {}: expected integers or floats of 8 to 64 bits", column.name));
  return column;
}

std::shared_ptr<const LasInfo> to_las(const nb::object& info) {
  if (info.is_none()) return nullptr;
  auto las = std::make_shared<LasInfo>();
  const auto bytes = [&](const char* name) {
    const auto raw = nb::cast<nb::bytes>(info.attr(name));
    const auto* data = static_cast<const std::byte*>(raw.data());
    return std::vector<std::byte>(data, data + raw.size());
  };
  las->scale = nb::cast<std::array<double, 3>>(info.attr("scale"));
  las->offset = nb::cast<std::array<double, 3>>(info.attr("offset"));
  las->point_format = nb::cast<std::uint8_t>(info.attr("point_format"));
  las->header = bytes("header");
  las->vlrs = bytes("vlrs");
  return las;
}

nb::object from_las(const LasInfo& las) {
  const auto bytes = [](const std::vector<std::byte>& raw) { return nb::bytes(raw.data(), raw.size()); };
  return nb::module_::import_("shapelight.geometry")
      .attr("LasInfo")(las.scale, las.offset, las.point_format, bytes(las.header), bytes(las.vlrs));
}

template <class T>
T get(const nb::dict& from, const char* name, T fallback) {
  return from.contains(name) ? nb::cast<T>(from[name]) : fallback;
}

Geometry rest_of(const nb::dict& given) {
  Geometry rest;
  rest.attributes = to_table(get(given, "attributes", nb::dict()));
  rest.triangle_attributes = to_table(get(given, "triangle_attributes", nb::dict()));
  if (const auto uv = get<std::optional<TexcoordArray>>(given, "corner_texcoords", std::nullopt)) {
    const auto* first = reinterpret_cast<const std::array<float, 2>*>(uv->data());
    rest.corner_texcoords.assign(first, first + uv->shape(0));
  }
  rest.coordinate_type =
      get<std::string>(given, "coordinate_type", "float64") == "float32" ? ScalarType::Float32 : ScalarType::Float64;
  rest.comments = get(given, "comments", rest.comments);
  rest.format = get(given, "format", rest.format);
  rest.las = to_las(get<nb::object>(given, "las", nb::none()));
  return rest;
}

}  // namespace

Vec3 to_vec3(const std::array<double, 3>& xyz) { return {xyz[0], xyz[1], xyz[2]}; }

RigidTransform to_transform(const PoseArray& pose) {
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(pose.data());
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const bool rigid = matrix.allFinite() && matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
                     (linear * linear.transpose()).isIdentity(1e-6) && linear.determinant() > 0.0;
  if (!rigid) throw InvalidInput("transform: expected a rigid motion: a rotation, a translation, and 0 0 0 1 below");
  RigidTransform transform = RigidTransform::Identity();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool exact = (linear * linear.transpose()).isIdentity(1e-14);
  transform.linear() = exact ? linear : Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose());
  transform.translation() = matrix.topRightCorner<3, 1>();
  return transform;
}

InputView::InputView(const PointsArray& positions, const std::optional<TrianglesArray>& triangles,
                     const std::optional<PixelArray>& pixels, const std::optional<std::array<double, 3>>& viewpoint,
                     const nb::dict& given)
    : positions_owner(nb::cast(positions)), rest(rest_of(given)) {
  view.positions = as_span(positions);
  if (triangles) {
    triangles_owner = nb::cast(*triangles);
    view.triangles = as_span(*triangles);
  }
  if (pixels) {
    grid.height = static_cast<std::uint32_t>(pixels->shape(0));
    grid.width = static_cast<std::uint32_t>(pixels->shape(1));
    grid.pixel.assign(pixels->data(), pixels->data() + pixels->size());
    for (std::size_t i = 0; i < grid.pixel.size(); ++i) {
      if (grid.pixel[i] == kNoIndex || grid.pixel[i] < positions.shape(0)) continue;
      throw InvalidInput(fmt::format("grid: row {}, column {}: point {} >= {} points", i / grid.width, i % grid.width,
                                     grid.pixel[i], positions.shape(0)));
    }
    view.grid = &grid;
  }
  if (viewpoint) view.viewpoint = to_vec3(*viewpoint);
  for (const auto& [table, count, what] : {std::tuple(&rest.attributes, view.positions.size(), "points"),
                                           std::tuple(&rest.triangle_attributes, view.triangles.size(), "triangles")}) {
    for (const Column& column : table->columns()) {
      if (column.size() == count) continue;
      throw InvalidInput(fmt::format("attribute {}: {} values, expected one for each of {} {}", column.name,
                                     column.size(), count, what));
    }
  }
  view.whole = &rest;
}

Geometry InputView::geometry() const {
  Geometry all = rest;
  all.positions.assign(view.positions.begin(), view.positions.end());
  all.triangles.assign(view.triangles.begin(), view.triangles.end());
  if (view.grid != nullptr) all.grid = grid;
  all.viewpoint = view.viewpoint;
  return all;
}

nb::dict to_dict(AttributeTable&& table) {
  nb::dict columns;
  for (const Column& column : table.columns()) {
    Column* moved = table.find(column.name);
    columns[column.name.c_str()] = std::visit([](auto& values) { return to_numpy(std::move(values)); }, moved->values);
  }
  return columns;
}

AttributeTable to_table(const nb::dict& columns) {
  constexpr std::size_t kTypes = std::variant_size_v<Column::Values>;
  AttributeTable table;
  for (const auto& [name, values] : columns) {
    const auto text = nb::cast<std::string>(name);
    AnyVector array;
    if (!nb::try_cast<AnyVector>(values, array)) {
      throw InvalidInput(fmt::format("attribute {}: expected a contiguous array of one dimension", text));
    }
    table.set(column_of(text, array, std::make_index_sequence<kTypes>{}));
  }
  return table;
}

nb::dict to_dict(Geometry&& geometry) {
  nb::dict d;
  d["positions"] = to_numpy(std::move(geometry.positions));
  d["triangles"] = to_numpy(std::move(geometry.triangles));
  d["attributes"] = to_dict(std::move(geometry.attributes));
  d["triangle_attributes"] = to_dict(std::move(geometry.triangle_attributes));
  if (!geometry.corner_texcoords.empty()) {
    const std::size_t n = geometry.corner_texcoords.size();
    d["corner_texcoords"] = own_as_numpy<float>(std::move(geometry.corner_texcoords), {n, 2});
  }
  if (geometry.grid) {
    d["grid"] = own_as_numpy<Index>(std::move(geometry.grid->pixel), {geometry.grid->height, geometry.grid->width});
  }
  if (geometry.viewpoint) d["viewpoint"] = to_numpy(*geometry.viewpoint);
  d["coordinate_type"] = std::string(scalar_type_name(geometry.coordinate_type));
  d["comments"] = geometry.comments;
  d["warnings"] = geometry.warnings;
  d["format"] = geometry.format;
  if (geometry.las) d["las"] = from_las(*geometry.las);
  return d;
}

nb::dict to_dict(const GraphDiagnostics& d) {
  nb::dict counts;
  counts["non_finite_points"] = d.non_finite_points;
  counts["duplicate_points"] = d.duplicate_points;
  counts["isolated_vertices"] = d.isolated_vertices;
  counts["outliers"] = d.outliers;
  counts["non_manifold_edges"] = d.non_manifold_edges;
  counts["degenerate_triangles"] = d.degenerate_triangles;
  counts["boundary_vertices"] = d.boundary_vertices;
  counts["components"] = d.components;
  return counts;
}

nb::dict to_dict(const MeshOddities& o) {
  nb::dict counts;
  counts["degenerate_faces"] = o.degenerate_faces;
  counts["duplicate_faces"] = o.duplicate_faces;
  counts["reoriented_faces"] = o.reoriented_faces;
  counts["split_vertices"] = o.split_vertices;
  counts["locked_vertices"] = o.locked_vertices;
  counts["unused_vertices"] = o.unused_vertices;
  return counts;
}

void bind_data(nb::module_& module) {
  nb::class_<InputView>(module, "GeometryView",
                        "Points, triangles, pixels and attributes as algorithms see them; arrays are not copied.")
      .def(nb::init<const PointsArray&, const std::optional<TrianglesArray>&, const std::optional<PixelArray>&,
                    const std::optional<std::array<double, 3>>&, const nb::dict&>(),
           nb::arg("positions").noconvert(), nb::arg("triangles").noconvert().none() = nb::none(),
           nb::arg("grid").noconvert().none() = nb::none(), nb::arg("viewpoint").none() = nb::none(),
           nb::arg("rest") = nb::dict())
      .def_prop_ro(
          "positions_address",
          [](const InputView& v) { return reinterpret_cast<std::uintptr_t>(v.view.positions.data()); },
          "Where the library reads the positions.")
      .def_prop_ro("kind", [](const InputView& v) { return std::string(geometry_kind_name(v.view.kind())); })
      .def_prop_ro(
          "diagonal", [](const InputView& v) { return bounding_box(v.view.positions).diagonal(); },
          "[input length unit] of the bounding box of the finite points.")
      .def_prop_ro(
          "bounding_box",
          [](const InputView& v) {
            const BoundingBox box = bounding_box(v.view.positions);
            return nb::make_tuple(to_numpy(box.min), to_numpy(box.max));
          },
          "The lowest and the highest corner, of the finite points.")
      .def(
          "select_points",
          [](const InputView& v, const VectorArray<Index>& indices) {
            for (const Index i : as_span(indices)) {
              if (i >= v.view.size()) throw InvalidInput(fmt::format("index {} >= {} points", i, v.view.size()));
            }
            return to_dict(select_points(v.view, as_span(indices)));
          },
          nb::arg("indices"))
      .def(
          "transformed",
          [](const InputView& v, const PoseArray& T_new_old) {
            Geometry moved = v.geometry();
            transform_geometry(moved, to_transform(T_new_old));
            return to_dict(std::move(moved));
          },
          nb::arg("T_new_old"));
}

}  // namespace shapelight::python
