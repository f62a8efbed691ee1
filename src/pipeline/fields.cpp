#include "shapelight/pipeline/fields.hpp"

#include <algorithm>
#include <limits>

#include "shapelight/features/noise.hpp"
#include "shapelight/sample/shape_sampling.hpp"

namespace shapelight {
namespace {

// Noise in mean edge lengths from which another estimator is better (docs/stages.md has the measurements).
constexpr double kCleanCloud = 0.03;
constexpr double kNoisy = 0.08;
constexpr int kNoisyPasses = 4;

struct Plan {
  CurvatureOptions curvature;
  SurfaceVariationOptions variation;
  bool denoise = false;
  bool noisy = false;
};

Plan plan_for(GeometryKind kind, double relative_noise, const FieldsOptions& options) {
  Plan plan{options.curvature, options.variation, options.denoise, relative_noise > kNoisy};
  if (!options.adaptive) return plan;
  if (kind == GeometryKind::Cloud) {
    plan.curvature.method = relative_noise < kCleanCloud ? CurvatureMethod::Quadric : CurvatureMethod::NormalField;
    plan.curvature.smoothing_passes = plan.noisy ? 1 : 0;
  } else {
    plan.curvature.method = CurvatureMethod::Taubin;
    plan.curvature.smoothing_passes = plan.noisy ? kNoisyPasses : 1;
  }
  plan.denoise = options.denoise && plan.noisy;
  // A third more neighbours average more noise out: 77 in place of 74 % of the local points of a noisy armadillo lie on
  // or beside true features. The price is a little coverage of the sharpest ones (36 neighbours: 1 to 3 %).
  if (plan.noisy) plan.variation.neighbors = std::min(1000, options.variation.neighbors * 4 / 3);
  return plan;
}

std::vector<double> curvedness_of(const Curvatures& curvatures) {
  std::vector<double> values(curvatures.k1.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = curvedness(curvatures.k1[i], curvatures.k2[i]);
  return values;
}

template <class T>
Column spread(const SurfaceGraph& graph, const std::vector<T>& per_vertex, std::string name, float missing) {
  std::vector<float> values(graph.vertex_of_point.size(), missing);
  for (std::size_t p = 0; p < values.size(); ++p) {
    const Index v = graph.vertex_of_point[p];
    if (v != kNoIndex) values[p] = static_cast<float>(per_vertex[v]);
  }
  return {std::move(name), std::move(values)};
}

Column spread_labels(const SurfaceGraph& graph, const std::vector<std::uint32_t>& label) {
  std::vector<std::int32_t> values(graph.vertex_of_point.size(), -1);
  for (std::size_t p = 0; p < values.size(); ++p) {
    const Index v = graph.vertex_of_point[p];
    if (v != kNoIndex) values[p] = static_cast<std::int32_t>(label[v]);
  }
  return {"segment", std::move(values)};
}

}  // namespace

FieldsOptions fields_preset(Preset preset) {
  FieldsOptions options;
  if (preset == Preset::Fast) {
    options.denoise = options.retinex = options.segment = false;
  } else if (preset == Preset::Paper) {
    options.adaptive = false;
    options.curvature.method = CurvatureMethod::Taubin;
    options.curvature.smoothing_passes = 0;
    options.shape_index.form = ShapeIndexForm::Literal;
  }
  return options;
}

SurfaceFields compute_fields(const SurfaceGraph& graph, GeometryKind kind, const FieldsOptions& options,
                             const RunContext& context) {
  validate_options(options);
  SurfaceFields fields;
  fields.noise = estimate_noise(graph, context.phase(0.0, 0.05, "estimate noise"));
  const double h = graph.mean_edge_length;
  const Plan plan = plan_for(kind, h > 0.0 ? fields.noise / h : 0.0, options);
  fields.curvature_method = plan.curvature.method;
  fields.curvature_passes = plan.curvature.smoothing_passes;

  Curvatures curvatures = estimate_curvatures(graph, plan.curvature, context.phase(0.05, 0.2, "estimate curvature"));
  fields.curvedness = curvedness_of(curvatures);
  fields.surface_variation =
      compute_surface_variation(graph, plan.variation, context.phase(0.2, 0.3, "measure surface variation"));
  fields.shape_index = compute_shape_index(graph, curvatures, fields.noise, options.shape_index,
                                           context.phase(0.3, 0.35, "shape index"));
  if (plan.denoise) {
    fields.shape_index = non_local_means(graph, fields.shape_index, curvatures.direction1, options.non_local_means,
                                         context.phase(0.35, 0.7, "non-local means"));
    fields.denoised = true;
  }
  if (options.retinex) {
    RetinexResult split =
        decompose_retinex(graph, fields.shape_index, options.retinex_options, context.phase(0.7, 0.85, "retinex"));
    fields.illumination = std::move(split.illumination);
    fields.reflectance = std::move(split.reflectance);
  }
  if (options.segment) {
    const std::vector<double>& cut = options.retinex ? fields.reflectance : fields.shape_index;
    SegmentationResult segments = segment_field(graph, cut, options.segmentation, context.phase(0.85, 0.95, "segment"));
    fields.segment = std::move(segments.label);
    fields.num_segments = segments.count;
  }
  const std::span<const double> modulation = options.retinex ? fields.shape_index : std::span<const double>{};
  fields.importance =
      sampling_density(graph, {fields.curvedness, fields.surface_variation, modulation, fields.reflectance, plan.noisy},
                       context.phase(0.95, 1.0, "importance"));
  fields.k1 = std::move(curvatures.k1);
  fields.k2 = std::move(curvatures.k2);
  return fields;
}

PointFields point_fields(const GeometryView& geometry, const FieldsOptions& options, const RunContext& context) {
  const BuiltGraph built = build_graph(geometry, options.graph, context.phase(0.0, 0.3, "build graph"));
  const SurfaceFields fields =
      compute_fields(built.graph, geometry.kind(), options, context.phase(0.3, 0.98, "compute fields"));
  PointFields result;
  result.noise = fields.noise;
  result.mean_edge_length = built.graph.mean_edge_length;
  result.denoised = fields.denoised;
  result.curvature_method = fields.curvature_method;
  result.num_segments = fields.num_segments;
  result.diagnostics = built.diagnostics;

  constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
  const auto add = [&](const char* name, const std::vector<double>& values) {
    result.attributes.set(spread(built.graph, values, name, kMissing));
  };
  add("shape_index", fields.shape_index);
  add("curvedness", fields.curvedness);
  if (options.retinex) {
    add("illumination", fields.illumination);
    add("reflectance", fields.reflectance);
  }
  if (options.segment) result.attributes.set(spread_labels(built.graph, fields.segment));
  add("importance", fields.importance);
  context.check();
  context.report(1.0, "done");
  return result;
}

}  // namespace shapelight
