#include "pipeline/simplify_guide.hpp"

#include <algorithm>

#include "shapelight/denoise/taubin_smoothing.hpp"
#include "shapelight/features/noise.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/sample/paper_sampling.hpp"
#include "shapelight/sample/shape_sampling.hpp"

namespace shapelight::pipeline {
namespace {

// Per point of the surface; points without a vertex stay.
std::vector<Vec3> denoise(const SurfaceGraph& graph, const Surface& surface, const RunContext& context) {
  const std::vector<Vec3> smooth = smooth_positions(graph, {}, context);
  const Vec3 shift = graph.origin - surface.origin;
  std::vector<Vec3> positions = surface.mesh.positions;
  for (std::size_t p = 0; p < positions.size(); ++p) {
    if (graph.vertex_of_point[p] != kNoIndex) positions[p] = smooth[graph.vertex_of_point[p]] + shift;
  }
  return positions;
}

}  // namespace

ShapeGuide::ShapeGuide(const GeometryView& geometry, const Surface& surface, const SimplifyOptions& options,
                       const RunContext& context)
    : paper_(options.preset == SimplifyPreset::Paper), local_weight_(options.local_weight) {
  graph_ = graph_from_mesh(geometry.positions, surface.mesh.triangles, context.phase(0.0, 0.3, "build graph")).graph;
  if (options.method == SimplifyMethod::Ssim && options.ssim.sample_weight == 1.0) {  // samples would have no say
    fields_.noise = estimate_noise(graph_, context.phase(0.3, 0.9, "estimate noise"));
  } else {
    FieldsOptions stages = options.fields;
    stages.segment = stages.segment && paper_;  // our ranking needs no segments
    fields_ = compute_fields(graph_, geometry.kind(), stages, context.phase(0.3, 0.9, "compute fields"));
    for (Index v = 0; v < graph_.size(); ++v) {
      if (!graph_.neighbors_of(v).empty() && !graph_.outlier[v]) candidates_.push_back(v);
    }
  }
  if (options.method == SimplifyMethod::Ssim && noise() > options.noise_threshold * mean_edge_length()) {
    denoised_ = denoise(graph_, surface, context.phase(0.9, 1.0, "denoise"));
  }
}

std::vector<Index> ShapeGuide::samples(std::size_t count, const RunContext& context) const {
  const SamplingTarget target{std::min(count, candidates_.size()), 0.0};
  if (target.count == 0) return {};
  std::vector<Index> chosen;
  if (paper_) {
    const std::vector<std::uint32_t> one_segment(fields_.segment.empty() ? graph_.size() : 0, 0);
    chosen =
        sample_paper(graph_, candidates_, fields_.shape_index, fields_.segment.empty() ? one_segment : fields_.segment,
                     target, {.local_weight = local_weight_}, context);
  } else {
    chosen = sample_by_shape(graph_, candidates_, fields_.importance, target, {.local_weight = local_weight_}, context);
  }
  for (Index& v : chosen) v = graph_.global_id[v];
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace shapelight::pipeline
