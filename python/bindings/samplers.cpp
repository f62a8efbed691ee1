#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <optional>

#include "arrays.hpp"
#include "bindings.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/sample/covariance.hpp"
#include "shapelight/sample/normal_space.hpp"
#include "shapelight/sample/paper_sampling.hpp"
#include "shapelight/sample/poisson.hpp"
#include "shapelight/sample/random.hpp"
#include "shapelight/sample/shape_sampling.hpp"
#include "shapelight/sample/stratified.hpp"
#include "shapelight/sample/voxel.hpp"

namespace shapelight::python {
namespace {

using OptionalField = std::optional<VectorArray<double>>;

// What a sampler is asked for: how many, and among which vertices; None: all that are no strays.
struct Request {
  SamplingTarget target;
  std::vector<Index> unflagged;
  std::span<const Index> candidates;

  Request(const SurfaceGraph& graph, std::size_t count, double spacing, const std::optional<VectorArray<Index>>& chosen)
      : target{.count = count, .spacing = spacing} {
    if (!chosen) {
      for (Index v = 0; v < graph.size(); ++v) {
        if (!graph.outlier[v]) unflagged.push_back(v);
      }
    }
    candidates = chosen ? as_span(*chosen) : std::span<const Index>(unflagged);
  }
};

std::span<const double> as_span(const OptionalField& field) {
  return field ? shapelight::python::as_span(*field) : std::span<const double>{};
}

template <class... Inputs, class Choose>
void bind_sampler(nb::module_& module, const char* name, Choose choose, const auto&... arguments) {
  module.def(
      name,
      [choose](const BuiltGraph& built, Inputs... inputs, std::size_t count, double spacing,
               const std::optional<VectorArray<Index>>& candidates, const nb::dict& given, nb::object threads,
               nb::object progress) {
        const Request request(built.graph, count, spacing, candidates);
        return to_numpy(choose(built.graph, request, inputs..., given, CallStyle{threads, progress}));
      },
      nb::arg("graph"), arguments..., nb::arg("count"), nb::arg("spacing"), nb::arg("candidates").noconvert().none(),
      nb::arg("options"), nb::arg("threads").none(), nb::arg("progress").none());
}

// Samplers that look at the graph alone.
template <class Options, auto sampler>
void bind_plain_sampler(nb::module_& module, const char* name) {
  publish_options<Options>(module, name);
  bind_sampler(module, name,
               [](const SurfaceGraph& graph, const Request& request, const nb::dict& given, const CallStyle& style) {
                 const auto options = make_options<Options>(given);
                 return run(style, [&](const RunContext& context) {
                   return sampler(graph, request.candidates, request.target, options, context);
                 });
               });
}

nb::object density(const BuiltGraph& built, const VectorArray<double>& curvedness,
                   const VectorArray<double>& surface_variation, const OptionalField& shape_index,
                   const OptionalField& reflectance, bool noisy, nb::object threads, nb::object progress) {
  const ShapeFields fields{shapelight::python::as_span(curvedness), shapelight::python::as_span(surface_variation),
                           as_span(shape_index), as_span(reflectance), noisy};
  return to_numpy(run({threads, progress},
                      [&](const RunContext& context) { return sampling_density(built.graph, fields, context); }));
}

std::vector<Index> by_shape(const SurfaceGraph& graph, const Request& request, const VectorArray<double>& density,
                            const nb::dict& given, const CallStyle& style) {
  const auto options = make_options<ShapeSamplingOptions>(given);
  return run(style, [&](const RunContext& context) {
    return sample_by_shape(graph, request.candidates, shapelight::python::as_span(density), request.target, options,
                           context);
  });
}

std::vector<Index> by_paper(const SurfaceGraph& graph, const Request& request, const VectorArray<double>& shape_index,
                            const VectorArray<std::uint32_t>& segment, const nb::dict& given, const CallStyle& style) {
  const auto options = make_options<PaperSamplingOptions>(given);
  return run(style, [&](const RunContext& context) {
    return sample_paper(graph, request.candidates, shapelight::python::as_span(shape_index),
                        shapelight::python::as_span(segment), request.target, options, context);
  });
}

std::vector<Index> farthest(const SurfaceGraph& graph, const Request& request, const nb::dict&,
                            const CallStyle& style) {
  return run(style, [&](const RunContext& context) {
    return sample_farthest(graph, request.candidates, request.target, context);
  });
}

}  // namespace

void bind_samplers(nb::module_& module) {
  const auto field = [](const char* name) { return nb::arg(name).noconvert(); };
  bind_plain_sampler<RandomSamplingOptions, &sample_random>(module, "sample_random");
  bind_plain_sampler<VoxelSamplingOptions, &sample_voxel>(module, "sample_voxel");
  bind_plain_sampler<StratifiedSamplingOptions, &sample_stratified>(module, "sample_stratified");
  bind_plain_sampler<PoissonSamplingOptions, &sample_poisson>(module, "sample_poisson");
  bind_plain_sampler<NormalSpaceSamplingOptions, &sample_normal_space>(module, "sample_normal_space");
  bind_plain_sampler<CovarianceSamplingOptions, &sample_covariance>(module, "sample_covariance");
  bind_sampler(module, "sample_farthest", &farthest);
  publish_options<ShapeSamplingOptions>(module, "sample_by_shape");
  bind_sampler<const VectorArray<double>&>(module, "sample_by_shape", &by_shape, field("density"));
  publish_options<PaperSamplingOptions>(module, "sample_paper");
  bind_sampler<const VectorArray<double>&, const VectorArray<std::uint32_t>&>(module, "sample_paper", &by_paper,
                                                                              field("shape_index"), field("segment"));
  module.def("sampling_density", &density, nb::arg("graph"), field("curvedness"), field("surface_variation"),
             field("shape_index").none(), field("reflectance").none(), nb::arg("noisy"), nb::arg("threads").none(),
             nb::arg("progress").none());
}

}  // namespace shapelight::python
