#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/simplify/qslim.hpp"
#include "shapelight/simplify/ssim.hpp"

namespace shapelight::python {
namespace {

using EdgesArray = nb::ndarray<const Index, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;  ///< (k, 2)

FeatureEdges to_edges(const EdgesArray& edges) {
  FeatureEdges pairs;
  for (std::size_t i = 0; i < edges.shape(0); ++i) pairs.push_back({edges(i, 0), edges(i, 1)});
  return pairs;
}

TriangleMesh to_mesh(const InputView& input) {
  const MeshView mesh = input.mesh();
  return {{mesh.positions.begin(), mesh.positions.end()}, {mesh.triangles.begin(), mesh.triangles.end()}};
}

// What all methods take beside their own options.
struct Request {
  TriangleMesh mesh;
  SimplifyTarget target;
  FeatureEdges features;
  CallStyle style;
};

template <class Simplify>
nb::dict run_simplify(const Request& request, Simplify&& simplify) {
  MeshOddities oddities;
  SimplifiedMesh result = run(request.style, [&](const RunContext& context) { return simplify(context, &oddities); });
  nb::dict d;
  d["vertices"] = to_numpy(std::move(result.mesh.positions));
  d["faces"] = to_numpy(std::move(result.mesh.triangles));
  d["source_vertex"] = to_numpy(std::move(result.source_vertex));
  d["oddities"] = to_dict(oddities);
  return d;
}

nb::dict qslim(const InputView& input, std::size_t vertices, std::size_t faces, const EdgesArray& features,
               const nb::dict& given, nb::object threads, nb::object progress) {
  const auto options = make_options<QslimOptions>(given);
  const Request r{to_mesh(input), {vertices, faces}, to_edges(features), {threads, progress}};
  return run_simplify(r, [&](const RunContext& context, MeshOddities* oddities) {
    return simplify_qslim(r.mesh, r.target, options, r.features, context, oddities);
  });
}

nb::dict ssim(const InputView& input, std::size_t vertices, std::size_t faces, const VectorArray<Index>& samples,
              const std::optional<PointsArray>& denoised, const EdgesArray& features, const nb::dict& given,
              nb::object threads, nb::object progress) {
  const auto options = make_options<SsimOptions>(given);
  SsimGuide guide{.samples = as_span(samples), .denoised = {}};
  if (denoised) guide.denoised = as_span(*denoised);
  const Request r{to_mesh(input), {vertices, faces}, to_edges(features), {threads, progress}};
  return run_simplify(r, [&](const RunContext& context, MeshOddities* oddities) {
    return simplify_ssim(r.mesh, r.target, guide, options, r.features, context, oddities);
  });
}

nb::dict ssim_paper(const InputView& input, std::size_t vertices, std::size_t faces, const VectorArray<Index>& samples,
                    const EdgesArray& features, nb::object threads, nb::object progress) {
  const Request r{to_mesh(input), {vertices, faces}, to_edges(features), {threads, progress}};
  return run_simplify(r, [&](const RunContext& context, MeshOddities* oddities) {
    return simplify_ssim_paper(r.mesh, r.target, as_span(samples), r.features, context, oddities);
  });
}

}  // namespace

void bind_simplify(nb::module_& module) {
  publish_options<QslimOptions>(module, "simplify_qslim");
  module.def("simplify_qslim", &qslim, nb::arg("mesh"), nb::arg("vertices"), nb::arg("faces"), nb::arg("features"),
             nb::arg("options"), nb::arg("threads").none(), nb::arg("progress").none());
  publish_options<SsimOptions>(module, "simplify_ssim");
  module.def("simplify_ssim", &ssim, nb::arg("mesh"), nb::arg("vertices"), nb::arg("faces"), nb::arg("samples"),
             nb::arg("denoised").none(), nb::arg("features"), nb::arg("options"), nb::arg("threads").none(),
             nb::arg("progress").none());
  module.def("simplify_ssim_paper", &ssim_paper, nb::arg("mesh"), nb::arg("vertices"), nb::arg("faces"),
             nb::arg("samples"), nb::arg("features"), nb::arg("threads").none(), nb::arg("progress").none());
}

}  // namespace shapelight::python
