#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <optional>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/metrics/surface_distance.hpp"

namespace shapelight::python {
namespace {

nb::dict sampling(const PointsArray& reference, const PointsArray& samples,
                  const std::optional<VectorArray<double>>& importance, nb::object threads, nb::object progress) {
  return to_dict(run({threads, progress}, [&](const RunContext& context) {
    return measure_sampling(as_span(reference), importance ? as_span(*importance) : std::span<const double>{},
                            as_span(samples), context);
  }));
}

nb::object variation(const PointsArray& points, std::size_t k, nb::object threads, nb::object progress) {
  return to_numpy(run({threads, progress},
                      [&](const RunContext& context) { return surface_variation_knn(as_span(points), k, context); }));
}

nb::dict surface_distance(const InputView& reference, const InputView& test, const nb::dict& given, nb::object threads,
                          nb::object progress) {
  const auto options = make_options<SurfaceDistanceOptions>(given);
  return to_dict(run({threads, progress}, [&](const RunContext& context) {
    return measure_surface_distance(reference.mesh(), test.mesh(), options, context);
  }));
}

nb::object distances(const InputView& mesh, const TriangleTree& surface, nb::object threads, nb::object progress) {
  return to_numpy(run({threads, progress},
                      [&](const RunContext& context) { return vertex_distances(mesh.mesh(), surface, context); }));
}

}  // namespace

void bind_metrics(nb::module_& module) {
  module.def("measure_sampling", &sampling, nb::arg("reference").noconvert(), nb::arg("samples").noconvert(),
             nb::arg("importance").noconvert().none(), nb::arg("threads").none(), nb::arg("progress").none());
  module.def("surface_variation_knn", &variation, nb::arg("points").noconvert(), nb::arg("k"),
             nb::arg("threads").none(), nb::arg("progress").none());
  publish_options<SurfaceDistanceOptions>(module, "measure_surface_distance");
  module.def("measure_surface_distance", &surface_distance, nb::arg("reference"), nb::arg("test"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
  module.def("vertex_distances", &distances, nb::arg("mesh"), nb::arg("surface"), nb::arg("threads").none(),
             nb::arg("progress").none());
}

}  // namespace shapelight::python
