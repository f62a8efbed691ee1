#include <fmt/format.h>
#include <nanobind/nanobind.h>

#include <algorithm>
#include <cmath>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "run.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/spatial/batch_queries.hpp"

namespace shapelight::python {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Found>
nb::object distances_of(const std::vector<Found>& found, std::initializer_list<std::size_t> shape) {
  std::vector<double> distances(found.size());
  std::transform(found.begin(), found.end(), distances.begin(),
                 [](const Found& f) { return std::sqrt(f.distance_sq); });
  return own_as_numpy<double>(std::move(distances), shape);
}

nb::object indices_of(const std::vector<Neighbor>& found, std::initializer_list<std::size_t> shape) {
  std::vector<Index> indices(found.size());
  std::transform(found.begin(), found.end(), indices.begin(), [](const Neighbor& f) { return f.index; });
  return own_as_numpy<Index>(std::move(indices), shape);
}

void bind_kd_tree(nb::module_& module) {
  module.def(
      "make_kd_tree",
      [](const PointsArray& points) {
        const std::span<const Vec3> places = as_span(points);
        for (std::size_t i = 0; i < places.size(); ++i) {
          if (!places[i].allFinite()) throw InvalidInput(fmt::format("kd-tree: point {} is not finite", i));
        }
        return run({}, [&](const RunContext&) { return KdTree(places); });
      },
      nb::arg("points").noconvert());
  nb::class_<KdTree>(module, "KdTree")
      .def("__len__", &KdTree::size)
      .def(
          "nearest",
          [](const KdTree& tree, const PointsArray& queries, std::size_t k, double radius, nb::object threads,
             nb::object progress) {
            const std::vector<Neighbor> found = run({threads, progress}, [&](const RunContext& context) {
              return nearest(tree, as_span(queries), k, radius, context);
            });
            const std::size_t n = queries.shape(0);
            return nb::make_tuple(distances_of(found, {n, k}), indices_of(found, {n, k}));
          },
          nb::arg("queries").noconvert(), nb::arg("k"), nb::arg("radius"), nb::arg("threads").none(),
          nb::arg("progress").none())
      .def(
          "within",
          [](const KdTree& tree, const PointsArray& queries, double radius, nb::object threads, nb::object progress) {
            NeighborLists lists = run({threads, progress}, [&](const RunContext& context) {
              return within(tree, as_span(queries), radius, context);
            });
            const std::size_t m = lists.found.size();
            return nb::make_tuple(own_as_numpy<std::int64_t>(std::move(lists.offsets), {queries.shape(0) + 1}),
                                  indices_of(lists.found, {m}), distances_of(lists.found, {m}));
          },
          nb::arg("queries").noconvert(), nb::arg("radius"), nb::arg("threads").none(), nb::arg("progress").none())
      .def(
          "all_nearest",
          [](const KdTree& tree, std::size_t k, nb::object threads, nb::object progress) {
            std::vector<Index> table =
                run({threads, progress}, [&](const RunContext& context) { return tree.all_nearest(k, context); });
            return own_as_numpy<Index>(std::move(table), {tree.size(), k});
          },
          nb::arg("k"), nb::arg("threads").none(), nb::arg("progress").none());
}

nb::tuple closest(const TriangleTree& tree, const PointsArray& queries, nb::object threads, nb::object progress) {
  const std::vector<TriangleTree::Hit> hits =
      run({threads, progress}, [&](const RunContext& context) { return tree.closest(as_span(queries), context); });
  std::vector<Index> triangles;
  std::vector<Vec3> points;
  triangles.reserve(hits.size());
  points.reserve(hits.size());
  for (const TriangleTree::Hit& hit : hits) {
    triangles.push_back(hit.triangle);
    points.push_back(hit.triangle == kNoIndex ? Vec3::Constant(std::nan("")) : hit.point);
  }
  return nb::make_tuple(distances_of(hits, {hits.size()}), to_numpy(std::move(triangles)), to_numpy(std::move(points)));
}

nb::tuple first_hit(const TriangleTree& tree, const PointsArray& origins, const PointsArray& directions,
                    nb::object threads, nb::object progress) {
  const std::vector<TriangleTree::RayHit> hits = run({threads, progress}, [&](const RunContext& context) {
    return first_hits(tree, as_span(origins), as_span(directions), context);
  });
  std::vector<double> distances;
  std::vector<Index> triangles;
  std::vector<Vec3> points, normals;
  const Vec3 nowhere = Vec3::Constant(std::nan(""));
  for (const TriangleTree::RayHit& hit : hits) {
    distances.push_back(hit ? hit.distance : kInfinity);
    triangles.push_back(hit.triangle);
    points.push_back(hit ? hit.point : nowhere);
    normals.push_back(hit ? hit.normal : nowhere);
  }
  return nb::make_tuple(to_numpy(std::move(distances)), to_numpy(std::move(triangles)), to_numpy(std::move(points)),
                        to_numpy(std::move(normals)));
}

nb::object closest_on_triangles(const PointsArray& queries, const PointsArray& a, const PointsArray& b,
                                const PointsArray& c) {
  std::vector<Vec3> points(queries.shape(0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = closest_point_on_triangle(as_span(queries)[i], as_span(a)[i], as_span(b)[i], as_span(c)[i]);
  }
  return to_numpy(std::move(points));
}

}  // namespace

void bind_spatial(nb::module_& module) {
  bind_kd_tree(module);
  module.def(
      "make_triangle_tree",
      [](const InputView& mesh, nb::object threads, nb::object progress) {
        return run({threads, progress}, [&](const RunContext& context) {
          const MeshView view = mesh.mesh();
          return TriangleTree(
              {{view.positions.begin(), view.positions.end()}, {view.triangles.begin(), view.triangles.end()}},
              context);
        });
      },
      nb::arg("mesh"), nb::arg("threads").none(), nb::arg("progress").none());
  nb::class_<TriangleTree>(module, "TriangleTree")
      .def("__len__", &TriangleTree::size)
      .def("closest", &closest, nb::arg("queries").noconvert(), nb::arg("threads").none(), nb::arg("progress").none())
      .def("first_hit", &first_hit, nb::arg("origins").noconvert(), nb::arg("directions").noconvert(),
           nb::arg("threads").none(), nb::arg("progress").none());
  module.def("closest_point_on_triangle", &closest_on_triangles, nb::arg("queries").noconvert(),
             nb::arg("a").noconvert(), nb::arg("b").noconvert(), nb::arg("c").noconvert());
}

}  // namespace shapelight::python
