#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/denoise/taubin_smoothing.hpp"
#include "shapelight/features/noise.hpp"
#include "shapelight/pipeline/fields.hpp"

namespace shapelight::python {
namespace {

using Field = VectorArray<double>;

nb::dict curvatures(const BuiltGraph& built, const nb::dict& given, nb::object threads, nb::object progress) {
  const auto options = make_options<CurvatureOptions>(given);
  Curvatures found = run({threads, progress},
                         [&](const RunContext& context) { return estimate_curvatures(built.graph, options, context); });
  nb::dict d;
  d["k1"] = to_numpy(std::move(found.k1));
  d["k2"] = to_numpy(std::move(found.k2));
  d["direction1"] = to_numpy(std::move(found.direction1));
  return d;
}

nb::object curvedness_of(const Field& k1, const Field& k2) {
  const std::span<const double> a = as_span(k1), b = as_span(k2);
  if (a.size() != b.size())
    throw InvalidInput(fmt::format("k1, k2: {} and {} values, expected as many", a.size(), b.size()));
  std::vector<double> values(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) values[i] = curvedness(a[i], b[i]);
  return to_numpy(std::move(values));
}

nb::object shape_index(const BuiltGraph& built, const Field& k1, const Field& k2, double sigma, const nb::dict& given,
                       nb::object threads, nb::object progress) {
  const auto options = make_options<ShapeIndexOptions>(given);
  const std::span<const double> a = as_span(k1), b = as_span(k2);
  return to_numpy(run({threads, progress}, [&](const RunContext& context) {
    const Curvatures curvatures{{a.begin(), a.end()}, {b.begin(), b.end()}, {}};
    return compute_shape_index(built.graph, curvatures, sigma, options, context);
  }));
}

nb::object surface_variation(const BuiltGraph& built, const nb::dict& given, nb::object threads, nb::object progress) {
  const auto options = make_options<SurfaceVariationOptions>(given);
  return to_numpy(run({threads, progress}, [&](const RunContext& context) {
    return compute_surface_variation(built.graph, options, context);
  }));
}

double noise(const BuiltGraph& built, nb::object threads, nb::object progress) {
  return run({threads, progress}, [&](const RunContext& context) { return estimate_noise(built.graph, context); });
}

nb::object denoise(const BuiltGraph& built, const Field& field, const PointsArray& direction1, const nb::dict& given,
                   nb::object threads, nb::object progress) {
  const auto options = make_options<NonLocalMeansOptions>(given);
  return to_numpy(run({threads, progress}, [&](const RunContext& context) {
    return non_local_means(built.graph, as_span(field), as_span(direction1), options, context);
  }));
}

nb::object smooth(const BuiltGraph& built, const nb::dict& given, nb::object threads, nb::object progress) {
  const auto options = make_options<TaubinSmoothingOptions>(given);
  return to_numpy(run({threads, progress},
                      [&](const RunContext& context) { return smooth_positions(built.graph, options, context); }));
}

nb::dict retinex(const BuiltGraph& built, const Field& field, const nb::dict& given, nb::object threads,
                 nb::object progress) {
  const auto options = make_options<RetinexOptions>(given);
  RetinexResult split = run({threads, progress}, [&](const RunContext& context) {
    return decompose_retinex(built.graph, as_span(field), options, context);
  });
  nb::dict d;
  d["illumination"] = to_numpy(std::move(split.illumination));
  d["reflectance"] = to_numpy(std::move(split.reflectance));
  return d;
}

nb::dict segment(const BuiltGraph& built, const Field& field, const nb::dict& given, nb::object threads,
                 nb::object progress) {
  const auto options = make_options<SegmentationOptions>(given);
  SegmentationResult cut = run({threads, progress}, [&](const RunContext& context) {
    return segment_field(built.graph, as_span(field), options, context);
  });
  nb::dict d;
  d["label"] = to_numpy(std::move(cut.label));
  d["count"] = cut.count;
  return d;
}

GeometryKind kind_named(const std::string& name) {
  for (const GeometryKind kind : {GeometryKind::Mesh, GeometryKind::RangeImage, GeometryKind::Cloud}) {
    if (geometry_kind_name(kind) == name) return kind;
  }
  throw InvalidInput(fmt::format("kind: '{}', expected one of 'mesh', 'range_image', 'cloud'", name));
}

nb::dict all_fields(const BuiltGraph& built, const std::string& kind, const std::string& preset, const nb::dict& given,
                    nb::object threads, nb::object progress) {
  FieldsOptions options = fields_preset(enum_named<Preset>("preset", preset));
  apply_options(options, given);
  SurfaceFields fields = run({threads, progress}, [&, kind = kind_named(kind)](const RunContext& context) {
    return compute_fields(built.graph, kind, options, context);
  });
  nb::dict d;
  d["noise"] = fields.noise;
  d["denoised"] = fields.denoised;
  d["curvature_method"] = std::string(enum_name(fields.curvature_method));
  d["curvature_passes"] = fields.curvature_passes;
  d["k1"] = to_numpy(std::move(fields.k1));
  d["k2"] = to_numpy(std::move(fields.k2));
  d["curvedness"] = to_numpy(std::move(fields.curvedness));
  d["shape_index"] = to_numpy(std::move(fields.shape_index));
  d["surface_variation"] = to_numpy(std::move(fields.surface_variation));
  d["illumination"] = to_numpy(std::move(fields.illumination));
  d["reflectance"] = to_numpy(std::move(fields.reflectance));
  d["segment"] = to_numpy(std::move(fields.segment));
  d["num_segments"] = fields.num_segments;
  d["importance"] = to_numpy(std::move(fields.importance));
  return d;
}

// A stage: the graph, its own inputs, and how to run.
template <class Options, class Function, class... Inputs>
void bind_stage(nb::module_& module, const char* name, Function* function, const Inputs&... inputs) {
  publish_options<Options>(module, name);
  module.def(name, function, nb::arg("graph"), inputs..., nb::arg("options"), nb::arg("threads").none(),
             nb::arg("progress").none());
}

}  // namespace

void bind_features(nb::module_& module) {
  const auto field = [](const char* name) { return nb::arg(name).noconvert(); };
  bind_stage<CurvatureOptions>(module, "estimate_curvatures", &curvatures);
  module.def("curvedness", &curvedness_of, field("k1"), field("k2"));
  bind_stage<ShapeIndexOptions>(module, "compute_shape_index", &shape_index, field("k1"), field("k2"),
                                nb::arg("sigma"));
  bind_stage<SurfaceVariationOptions>(module, "compute_surface_variation", &surface_variation);
  module.def("estimate_noise", &noise, nb::arg("graph"), nb::arg("threads").none(), nb::arg("progress").none());
  bind_stage<NonLocalMeansOptions>(module, "non_local_means", &denoise, field("field"), field("direction1"));
  bind_stage<TaubinSmoothingOptions>(module, "smooth_positions", &smooth);
  bind_stage<RetinexOptions>(module, "decompose_retinex", &retinex, field("field"));
  bind_stage<SegmentationOptions>(module, "segment_field", &segment, field("field"));
  module.def("compute_fields", &all_fields, nb::arg("graph"), nb::arg("kind"), nb::arg("preset"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
}

}  // namespace shapelight::python
