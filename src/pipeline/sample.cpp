#include "shapelight/pipeline/sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/sample_graph.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/sample/covariance.hpp"
#include "shapelight/sample/normal_space.hpp"
#include "shapelight/sample/paper_sampling.hpp"
#include "shapelight/sample/poisson.hpp"
#include "shapelight/sample/random.hpp"
#include "shapelight/sample/shape_sampling.hpp"
#include "shapelight/sample/stratified.hpp"
#include "shapelight/sample/voxel.hpp"

namespace shapelight {
namespace {

// Methods that look at positions only do without neighbourhoods, unless the border shall be known.
bool needs_neighborhood(const SampleOptions& options) {
  return options.skip_boundary || options.method == SamplingMethod::Shape || options.method == SamplingMethod::Normal ||
         options.method == SamplingMethod::Covariance;
}

// What may be chosen: first the candidates, then the last resort in this order.
struct Choice {
  std::vector<Index> candidates;   // graph vertices, ascending
  std::vector<Index> last_resort;  // input indices: flagged vertices, then duplicates
};

Choice choices(const SurfaceGraph& graph, bool skip_boundary) {
  Choice choice;
  for (Index v = 0; v < graph.size(); ++v) {
    if (skip_boundary && graph.boundary[v]) continue;
    if (graph.outlier[v]) {
      choice.last_resort.push_back(graph.global_id[v]);
    } else {
      choice.candidates.push_back(v);
    }
  }
  for (Index p = 0; p < graph.vertex_of_point.size(); ++p) {
    const Index v = graph.vertex_of_point[p];
    const bool duplicate = v != kNoIndex && graph.global_id[v] != p;
    if (duplicate && !(skip_boundary && graph.boundary[v])) choice.last_resort.push_back(p);
  }
  return choice;
}

std::size_t count_of(const SampleSize& size, std::size_t usable, std::size_t reachable) {
  if (size.spacing) return 0;
  const auto rounded = [&] {
    return std::max<std::uint64_t>(1, std::llround(*size.ratio * static_cast<double>(usable)));
  };
  const std::uint64_t count = size.count ? *size.count : rounded();
  if (count > reachable) {
    throw TargetUnreachable(
        fmt::format("{} points asked for, but only {} of {} finite points can be chosen", count, reachable, usable),
        reachable);
  }
  return count;
}

std::vector<Index> sample_shape(const SurfaceGraph& graph, GeometryKind kind, std::span<const Index> candidates,
                                const SamplingTarget& target, const SampleOptions& options, SampleResult& result,
                                const RunContext& context) {
  FieldsOptions stages = options.fields;
  const bool paper = options.preset == Preset::Paper;
  stages.segment = stages.segment && paper;  // our ranking needs no segments
  const SurfaceFields fields = compute_fields(graph, kind, stages, context.phase(0.0, 0.6, "compute fields"));
  result.noise = fields.noise;
  result.denoised = fields.denoised;
  const RunContext choose = context.phase(0.6, 1.0, "choose points");
  if (paper) {
    const std::vector<std::uint32_t> one_segment(fields.segment.empty() ? graph.size() : 0, 0);
    return sample_paper(graph, candidates, fields.shape_index, fields.segment.empty() ? one_segment : fields.segment,
                        target, {.local_weight = options.local_weight}, choose);
  }
  return sample_by_shape(graph, candidates, fields.importance, target, {.local_weight = options.local_weight}, choose);
}

std::vector<Index> run_method(const SurfaceGraph& graph, GeometryKind kind, std::span<const Index> candidates,
                              const SamplingTarget& target, const SampleOptions& options, SampleResult& result,
                              const RunContext& context) {
  switch (options.method) {
    case SamplingMethod::Random:
      return sample_random(graph, candidates, target, {.seed = options.seed}, context);
    case SamplingMethod::Voxel:
      return sample_voxel(graph, candidates, target, {}, context);
    case SamplingMethod::Stratified:
      return sample_stratified(graph, candidates, target, {.seed = options.seed}, context);
    case SamplingMethod::Farthest:
      return sample_farthest(graph, candidates, target, context);
    case SamplingMethod::Poisson:
      return sample_poisson(graph, candidates, target, {.seed = options.seed}, context);
    case SamplingMethod::Normal:
      return sample_normal_space(graph, candidates, target, {.seed = options.seed}, context);
    case SamplingMethod::Covariance:
      return sample_covariance(graph, candidates, target, {}, context);
    case SamplingMethod::Shape:
      break;
  }
  return sample_shape(graph, kind, candidates, target, options, result, context);
}

}  // namespace

void validate(const SampleSize& size) {
  if (size.count.has_value() + size.ratio.has_value() + size.spacing.has_value() != 1) {
    throw InvalidInput("expected exactly one of --count, --ratio and --spacing");
  }
  if (size.count && *size.count == 0) throw InvalidInput("--count: 0 is out of range, expected at least 1 point");
  if (size.ratio && !(*size.ratio > 0.0 && *size.ratio <= 1.0)) {
    throw InvalidInput(fmt::format("--ratio: {:g} is out of range, expected more than 0 and at most 1", *size.ratio));
  }
  if (size.spacing && !(*size.spacing > 0.0 && std::isfinite(*size.spacing))) {
    throw InvalidInput(fmt::format("--spacing: {:g} is out of range, expected a positive length", *size.spacing));
  }
}

SampleOptions sample_preset(Preset preset) {
  SampleOptions options;
  options.preset = preset;
  options.fields = fields_preset(preset);
  return options;
}

SampleResult sample_graph(const BuiltGraph& built, GeometryKind kind, const SampleSize& size,
                          const SampleOptions& options, const RunContext& context) {
  validate(size);
  validate_options(options);
  const SurfaceGraph& graph = built.graph;
  const Choice choice = choices(graph, options.skip_boundary);

  SampleResult result;
  result.diagnostics = built.diagnostics;
  result.usable = graph.vertex_of_point.size() - built.diagnostics.non_finite_points;
  result.candidates = choice.candidates.size();
  const std::size_t count = count_of(size, result.usable, choice.candidates.size() + choice.last_resort.size());
  const SamplingTarget target{std::min(count, choice.candidates.size()), size.spacing.value_or(0.0)};
  if (!choice.candidates.empty()) {
    result.indices = run_method(graph, kind, choice.candidates, target, options, result, context);
    for (Index& v : result.indices) v = graph.global_id[v];
  }
  if (count > result.indices.size()) {
    result.last_resort = count - result.indices.size();
    result.indices.insert(result.indices.end(), choice.last_resort.begin(),
                          choice.last_resort.begin() + static_cast<std::ptrdiff_t>(result.last_resort));
  }
  context.check();
  return result;
}

SampleResult sample(const GeometryView& geometry, const SampleSize& size, const SampleOptions& options,
                    const RunContext& context) {
  validate(size);
  validate_options(options);
  const RunContext prepare = context.phase(0.0, 0.35, "build graph");
  const BuiltGraph built = needs_neighborhood(options) ? build_graph(geometry, options.fields.graph, prepare)
                                                       : graph_of_places(geometry.positions, prepare);
  SampleResult result = sample_graph(built, geometry.kind(), size, options, context.phase(0.35, 1.0, "sample"));
  context.report(1.0, "done");
  return result;
}

}  // namespace shapelight
