#include "recorder.hpp"
#include "shapelight/denoise/taubin_smoothing.hpp"
#include "shapelight/features/noise.hpp"
#include "shapelight/pipeline/fields.hpp"

namespace shapelight::parity {
namespace {

void record_fields(const Recorder& recorder, const std::string& name, const SurfaceFields& fields) {
  recorder.record(name + ".noise", fields.noise);
  recorder.record(name + ".denoised", static_cast<std::uint8_t>(fields.denoised));
  recorder.record(name + ".curvature_method", static_cast<std::uint8_t>(fields.curvature_method));
  recorder.record(name + ".curvature_passes", fields.curvature_passes);
  recorder.record(name + ".k1", fields.k1);
  recorder.record(name + ".k2", fields.k2);
  recorder.record(name + ".curvedness", fields.curvedness);
  recorder.record(name + ".shape_index", fields.shape_index);
  recorder.record(name + ".surface_variation", fields.surface_variation);
  recorder.record(name + ".illumination", fields.illumination);
  recorder.record(name + ".reflectance", fields.reflectance);
  recorder.record(name + ".segment", fields.segment);
  recorder.record(name + ".num_segments", fields.num_segments);
  recorder.record(name + ".importance", fields.importance);
}

}  // namespace

void record_features(const Recorder& recorder) {
  const BuiltGraph built = build_graph(data("meshes/fandisk.off"));
  const SurfaceGraph& graph = built.graph;
  const Curvatures curvatures =
      estimate_curvatures(graph, {.method = CurvatureMethod::Quadric, .smoothing_passes = 2, .neighbors = 15});
  recorder.record("estimate_curvatures.k1", curvatures.k1);
  recorder.record("estimate_curvatures.k2", curvatures.k2);
  recorder.record("estimate_curvatures.direction1", curvatures.direction1);
  std::vector<double> bends;
  for (std::size_t i = 0; i < graph.size(); ++i) bends.push_back(curvedness(curvatures.k1[i], curvatures.k2[i]));
  recorder.record("curvedness", bends);
  const double sigma = estimate_noise(graph);
  recorder.record("estimate_noise", sigma);
  const std::vector<double> index = compute_shape_index(graph, curvatures, sigma, {.flatness = 0.1});
  recorder.record("compute_shape_index", index);
  recorder.record("compute_surface_variation",
                  compute_surface_variation(graph, {SurfaceVariationMethod::Diffusion, 40}));
  recorder.record("non_local_means", non_local_means(graph, index, curvatures.direction1, {.window_rings = 2}));
  recorder.record("smooth_positions", smooth_positions(graph, {.iterations = 3}));
  const RetinexResult split = decompose_retinex(graph, index, {.spatial_sigma = 4.0});
  recorder.record("decompose_retinex.illumination", split.illumination);
  recorder.record("decompose_retinex.reflectance", split.reflectance);
  const SegmentationResult cut = segment_field(graph, split.reflectance, {.min_points = 50});
  recorder.record("segment_field.label", cut.label);
  recorder.record("segment_field.count", cut.count);

  record_fields(recorder, "compute_fields", compute_fields(graph, GeometryKind::Mesh, FieldsOptions{}));
  FieldsOptions paper = fields_preset(Preset::Paper);
  paper.curvature.smoothing_passes = 3;
  record_fields(recorder, "compute_fields.paper", compute_fields(graph, GeometryKind::Cloud, paper));
}

}  // namespace shapelight::parity
