#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <optional>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/graph/build_graph.hpp"

namespace shapelight::python {
namespace {

using PointsView = nb::ndarray<nb::numpy, const double, nb::shape<-1, 3>, nb::c_contig>;
template <class T>
using VectorView = nb::ndarray<nb::numpy, const T, nb::ndim<1>, nb::c_contig>;

// Read-only arrays that look into the graph; reference_internal, the policy of properties, keeps it alive.
VectorView<std::uint32_t> look(const std::vector<std::uint32_t>& v) { return {v.data(), {v.size()}}; }
VectorView<std::uint8_t> look(const std::vector<std::uint8_t>& v) { return {v.data(), {v.size()}}; }
VectorView<float> look(const std::vector<float>& v) { return {v.data(), {v.size()}}; }
VectorView<double> look(const std::vector<double>& v) { return {v.data(), {v.size()}}; }
PointsView look(const std::vector<Vec3>& v) {
  return {reinterpret_cast<const double*>(v.data()), {v.size(), std::size_t{3}}};
}
VectorView<double> look(const Vec3& v) { return {v.data(), {std::size_t{3}}}; }

std::string describe(const BuiltGraph& g) {
  return fmt::format(
      "SurfaceGraph({} vertices, {} edges, {} boundary, {} outliers, mean edge length {:.6g}, area {:.6g})",
      g.graph.size(), g.graph.neighbors.size() / 2, g.diagnostics.boundary_vertices, g.diagnostics.outliers,
      g.graph.mean_edge_length, g.graph.total_area);
}

void check_vertex(const SurfaceGraph& graph, std::size_t vertex) {
  if (vertex < graph.size()) return;
  throw InvalidInput(fmt::format("vertex {}: expected one below {}, the vertices there are", vertex, graph.size()));
}

void bind_surface_graph(nb::module_& module) {
  using Built = BuiltGraph;
  nb::class_<Built>(module, "SurfaceGraph",
                    "The neighbourhood that every stage works on. Its vertices are the distinct finite points of the "
                    "input in an order of its own; stages take and return one value for each of them. Arrays are "
                    "read-only views.")
      .def_prop_ro(
          "offsets", [](const Built& b) { return look(b.graph.offsets); },
          "(n + 1,) The neighbours of vertex i are neighbors[offsets[i]:offsets[i + 1]].")
      .def_prop_ro(
          "neighbors", [](const Built& b) { return look(b.graph.neighbors); },
          "(m,) Vertices; ascending for each vertex, every edge from both ends.")
      .def_prop_ro(
          "weight", [](const Built& b) { return look(b.graph.weight); }, "(m,) [area] of the triangles at the edge.")
      .def_prop_ro(
          "position", [](const Built& b) { return look(b.graph.position); },
          "(n, 3) [input length unit] relative to `origin`.")
      .def_prop_ro(
          "normal", [](const Built& b) { return look(b.graph.normal); },
          "(n, 3) Unit, consistently oriented; zero where undefined.")
      .def_prop_ro(
          "area", [](const Built& b) { return look(b.graph.area); },
          "(n,) [input length unit squared] surface that the vertex stands for.")
      .def_prop_ro(
          "boundary", [](const Built& b) { return look(b.graph.boundary); }, "(n,) 1 on the border of an open surface.")
      .def_prop_ro(
          "outlier", [](const Built& b) { return look(b.graph.outlier); }, "(n,) 1 for strays.")
      .def_prop_ro(
          "global_id", [](const Built& b) { return look(b.graph.global_id); },
          "(n,) Input index of the vertex, the lowest of its duplicates.")
      .def_prop_ro(
          "vertex_of_point", [](const Built& b) { return look(b.graph.vertex_of_point); },
          "(points,) Vertex of an input point; 0xFFFFFFFF for one that is not finite.")
      .def_prop_ro(
          "origin", [](const Built& b) { return look(b.graph.origin); },
          "(3,) Centre of the bounding box, input frame.")
      .def_prop_ro(
          "mean_edge_length", [](const Built& b) { return b.graph.mean_edge_length; }, "[input length unit].")
      .def_prop_ro(
          "total_area", [](const Built& b) { return b.graph.total_area; }, "[input length unit squared].")
      .def_prop_ro(
          "diagnostics", [](const Built& b) { return to_dict(b.diagnostics); },
          "Oddities met while the graph was built, counted.")
      .def(
          "neighbors_of",
          [](nb::handle_t<Built> self, std::size_t vertex) {
            const SurfaceGraph& graph = nb::cast<const Built&>(self).graph;
            check_vertex(graph, vertex);
            const auto found = graph.neighbors_of(vertex);
            return VectorView<std::uint32_t>(found.data(), {found.size()}, self);
          },
          nb::arg("vertex"), "The neighbours of one vertex, ascending.")
      .def("__len__", [](const Built& b) { return b.graph.size(); })
      .def("__repr__", &describe);
}

void bind_ring_collector(nb::module_& module) {
  struct Rings {
    const SurfaceGraph& graph;
    RingCollector collector;
    explicit Rings(const BuiltGraph& built) : graph(built.graph), collector(built.graph) {}
  };
  nb::class_<Rings>(module, "RingCollector", "Rings around a vertex, by breadth-first search.")
      .def(nb::init<const BuiltGraph&>(), nb::arg("graph"), nb::keep_alive<1, 2>())
      .def(
          "collect",
          [](Rings& rings, std::size_t center, int num_rings, std::optional<std::size_t> limit) {
            check_vertex(rings.graph, center);
            if (limit == std::size_t{0}) throw InvalidInput("limit: 0, expected at least 1 vertex");
            const std::size_t most = std::min(limit.value_or(rings.graph.size()), rings.graph.size());
            const auto found = rings.collector.collect(static_cast<Index>(center), num_rings, most);
            return nb::cast<VectorView<Index>>(to_numpy(std::vector<Index>(found.begin(), found.end())));
          },
          nb::arg("center"), nb::arg("rings"), nb::arg("limit") = nb::none(),
          "Vertices within `rings` steps of `center`, itself first, then ring by ring; at most `limit` in all.");
}

template <class Build>
void bind_builder(nb::module_& module, const char* name, Build build) {
  module.def(
      name,
      [build](const InputView& input, const nb::dict& given, nb::object threads, nb::object progress) {
        const auto options = make_options<GraphOptions>(given);
        return run({threads, progress}, [&](const RunContext& context) { return build(input, options, context); });
      },
      nb::arg("input"), nb::arg("options"), nb::arg("threads").none(), nb::arg("progress").none());
}

}  // namespace

void bind_graph(nb::module_& module) {
  bind_surface_graph(module);
  bind_ring_collector(module);
  publish_options<GraphOptions>(module, "build_graph");
  bind_builder(module, "build_graph", [](const InputView& in, const GraphOptions& options, const RunContext& context) {
    return build_graph(in.view, options, context);
  });
  bind_builder(module, "graph_from_mesh", [](const InputView& in, const GraphOptions&, const RunContext& context) {
    return graph_from_mesh(in.view.positions, in.view.triangles, context);
  });
  bind_builder(module, "graph_from_range_image",
               [](const InputView& in, const GraphOptions& options, const RunContext& context) {
                 return graph_from_range_image(in.view.positions, in.grid, in.view.viewpoint, options, context);
               });
  bind_builder(module, "graph_from_points",
               [](const InputView& in, const GraphOptions& options, const RunContext& context) {
                 return graph_from_points(in.view.positions, in.view.viewpoint, options, context);
               });
  bind_builder(module, "graph_of_places", [](const InputView& in, const GraphOptions&, const RunContext& context) {
    return graph_of_places(in.view.positions, context);
  });
  module.def(
      "range_image_triangles",
      [](const InputView& in, double depth_jump) {
        return to_numpy(run({}, [&](const RunContext&) {
          return range_image_triangles(in.view.positions, in.grid, in.view.viewpoint, depth_jump);
        }));
      },
      nb::arg("input"), nb::arg("depth_jump"));
  module.def(
      "validate", [](const BuiltGraph& built) { validate(built.graph); }, nb::arg("graph"));
}

}  // namespace shapelight::python
