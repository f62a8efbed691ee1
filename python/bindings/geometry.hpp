#pragma once

#include <nanobind/nanobind.h>

#include <optional>

#include "arrays.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/metrics/surface_distance.hpp"
#include "shapelight/simplify/simplified_mesh.hpp"

namespace shapelight::python {

/// Arrays of Python, as the library's algorithms see them: not copied, and kept alive.
struct InputView {
  nb::object positions_owner, triangles_owner;
  RangeGrid grid;
  Geometry rest;  // attributes and the like; without positions and triangles
  GeometryView view;

  InputView(const PointsArray& positions, const std::optional<TrianglesArray>& triangles,
            const std::optional<nb::ndarray<const Index, nb::ndim<2>, nb::c_contig, nb::device::cpu>>& pixels,
            const std::optional<std::array<double, 3>>& viewpoint, const nb::dict& rest);
  InputView(const InputView&) = delete;
  InputView& operator=(const InputView&) = delete;

  /// A copy of everything.
  [[nodiscard]] Geometry geometry() const;
  [[nodiscard]] MeshView mesh() const { return {view.positions, view.triangles}; }
};

/// The keyword arguments of shapelight.Geometry. Arrays are moved.
[[nodiscard]] nb::dict to_dict(Geometry&& geometry);
/// {name: array}, moved.
[[nodiscard]] nb::dict to_dict(AttributeTable&& table);
[[nodiscard]] AttributeTable to_table(const nb::dict& columns);

[[nodiscard]] nb::dict to_dict(const GraphDiagnostics& diagnostics);
[[nodiscard]] nb::dict to_dict(const MeshOddities& oddities);
[[nodiscard]] nb::dict to_dict(const SurfaceDistance& distance);
[[nodiscard]] nb::dict to_dict(const SamplingQuality& quality);

}  // namespace shapelight::python
