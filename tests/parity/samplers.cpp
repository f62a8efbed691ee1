#include "recorder.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/sample/covariance.hpp"
#include "shapelight/sample/normal_space.hpp"
#include "shapelight/sample/paper_sampling.hpp"
#include "shapelight/sample/poisson.hpp"
#include "shapelight/sample/random.hpp"
#include "shapelight/sample/shape_sampling.hpp"
#include "shapelight/sample/stratified.hpp"
#include "shapelight/sample/voxel.hpp"

namespace shapelight::parity {

void record_samplers(const Recorder& recorder) {
  const BuiltGraph built = build_graph(data("meshes/fandisk.off"));
  const SurfaceGraph& graph = built.graph;
  std::vector<Index> all, even;  // the mesh has no strays
  std::vector<double> field, raised, signed_field;
  std::vector<std::uint32_t> label;
  for (Index v = 0; v < graph.size(); ++v) {
    all.push_back(v);
    if (v % 2 == 0) even.push_back(v);
    field.push_back(v % 7);
    raised.push_back(v % 11 + 1);
    signed_field.push_back((v % 5) * 0.5 - 1.0);
    label.push_back(v / 1000);
  }
  const SamplingTarget count{.count = 300};
  const SamplingTarget spacing{.spacing = 0.2};
  recorder.record("sample_random", sample_random(graph, even, count, {.seed = 7, .area_weighted = true}));
  recorder.record("sample_voxel.count", sample_voxel(graph, even, count, {.fill_share = 0.3}));
  recorder.record("sample_voxel.spacing", sample_voxel(graph, all, spacing));
  recorder.record("sample_stratified.count", sample_stratified(graph, even, count, {.suppression = 0.2}));
  recorder.record("sample_stratified.spacing", sample_stratified(graph, all, spacing, {.seed = 7}));
  recorder.record("sample_poisson.count", sample_poisson(graph, even, count, {.seed = 7, .passes = 1}));
  recorder.record("sample_poisson.spacing", sample_poisson(graph, all, spacing, {.seed = 7}));
  recorder.record("sample_normal_space", sample_normal_space(graph, even, count, {.collars = 5}));
  recorder.record("sample_covariance", sample_covariance(graph, even, count));
  recorder.record("sample_farthest.count", sample_farthest(graph, even, count));
  recorder.record("sample_farthest.spacing", sample_farthest(graph, all, spacing));
  recorder.record("sample_by_shape.count", sample_by_shape(graph, even, field, count, {.local_weight = 0.9}));
  recorder.record("sample_by_shape.spacing", sample_by_shape(graph, all, field, spacing));
  recorder.record("sample_paper", sample_paper(graph, even, signed_field, label, count, {.local_weight = 0.3}));
  recorder.record("sampling_density", sampling_density(graph, {field, raised, {}, {}, true}));
  recorder.record("sampling_density.modulated", sampling_density(graph, {field, raised, signed_field, field}));
}

}  // namespace shapelight::parity
