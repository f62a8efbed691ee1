#include "shapelight/pipeline/simplify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/simplify_guide.hpp"
#include "pipeline/simplify_search.hpp"
#include "pipeline/simplify_surface.hpp"
#include "pipeline/transfer_attributes.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/simplify/qslim.hpp"
#include "simplify/check_result.hpp"
#include "simplify/turned_faces.hpp"

namespace shapelight {
namespace {

using pipeline::ShapeGuide;
using pipeline::Surface;

constexpr double kFirstGuess = 0.1;  // share of the vertices at which the search for an error starts

// One input surface, simplified to one target after another.
class Simplifier {
 public:
  Simplifier(const GeometryView& geometry, const SimplifyOptions& options, const RunContext& context)
      : geometry_(geometry),
        options_(options),
        surface_(pipeline::make_surface(geometry, options.fields.graph, context)) {
    const RunContext prepare = context.phase(0.0, 0.3, "prepare");
    reference_ = without_oddities(surface_.mesh, oddities_, prepare);
    if (reference_.mesh.triangles.empty()) throw InvalidInput("the input has no usable face to simplify");
    features_ = pipeline::texture_seams(geometry.rest(), surface_, prepare);
    if (options.method != SimplifyMethod::Qslim)
      guide_.emplace(geometry, surface_, options, context.phase(0.3, 1.0, ""));
  }

  [[nodiscard]] std::size_t vertices() const { return reference_.mesh.positions.size(); }
  [[nodiscard]] std::size_t faces() const { return reference_.mesh.triangles.size(); }
  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const MeshOddities& oddities() const { return oddities_; }
  [[nodiscard]] const std::optional<ShapeGuide>& guide() const { return guide_; }

  [[nodiscard]] SimplifiedMesh run(const SimplifyTarget& target, const RunContext& context) const {
    return run(options_.method, target, context);
  }
  [[nodiscard]] SimplifiedMesh run(SimplifyMethod method, const SimplifyTarget& target,
                                   const RunContext& context) const {
    if (target.vertices > vertices()) throw unreachable("vertices", target.vertices, vertices());
    if (target.faces > faces()) throw unreachable("faces", target.faces, faces());
    SimplifiedMesh result = simplified(method, target, context.phase(0.0, 0.95, "collapse"));
    (void)unfold_faces(surface_.mesh, result, options_.ssim.placement, features_, context);
    check_result(reference_, result, target, options_.ssim.placement, context.phase(0.95, 1.0, "check"));
    return result;
  }

 private:
  static TargetUnreachable unreachable(std::string_view unit, std::size_t asked, std::size_t there) {
    return {fmt::format("{} {} asked for, but the surface has only {}", asked, unit, there), there};
  }

  [[nodiscard]] SimplifiedMesh simplified(SimplifyMethod method, const SimplifyTarget& target,
                                          const RunContext& context) const {
    const SsimOptions& ssim = options_.ssim;
    if (method == SimplifyMethod::Qslim) {
      return simplify_qslim(surface_.mesh, target,
                            {.placement = ssim.placement, .boundary_weight = ssim.boundary_weight}, features_, context);
    }
    const std::size_t count = target.vertices > 0 ? target.vertices : target.faces * vertices() / faces();
    const std::vector<Index> samples = guide_->samples(count, context.phase(0.0, 0.1, "choose samples"));
    const RunContext rest = context.phase(0.1, 1.0, "collapse");
    if (method == SimplifyMethod::SsimPaper)
      return simplify_ssim_paper(surface_.mesh, target, samples, features_, rest);
    return simplify_ssim(surface_.mesh, target, {samples, guide_->denoised()}, ssim, features_, rest);
  }

  const GeometryView& geometry_;
  const SimplifyOptions& options_;
  Surface surface_;
  SimplifiedMesh reference_;  // the surface without its oddities
  MeshOddities oddities_;
  FeatureEdges features_;
  std::optional<ShapeGuide> guide_;
};

std::size_t share_of(double ratio, std::size_t count) {
  return static_cast<std::size_t>(std::max(1LL, std::llround(ratio * static_cast<double>(count))));
}

std::size_t num_finite(const GeometryView& geometry) {
  return static_cast<std::size_t>(
      std::count_if(geometry.positions.begin(), geometry.positions.end(), [](const Vec3& p) { return p.allFinite(); }));
}

SimplifyTarget target_of(const SimplifySize& size, const Simplifier& simplifier, SimplifyResult& result) {
  if (size.vertices) return {.vertices = *size.vertices, .faces = 0};
  if (size.faces) return {.vertices = 0, .faces = *size.faces};
  const std::size_t asked = share_of(*size.ratio, result.vertices_in);
  if (asked > simplifier.vertices()) {
    result.warnings.push_back(
        fmt::format("the ratio asks for {} vertices, the surface has {}: all are kept", asked, simplifier.vertices()));
  }
  return {.vertices = std::min(asked, simplifier.vertices()), .faces = 0};
}

SurfaceDistance measure(const Simplifier& simplifier, const SimplifiedMesh& result, const RunContext& context) {
  return measure_surface_distance(simplifier.surface().mesh, result.mesh, {}, context);
}

// The coarsest result within the bound.
SimplifiedMesh search_by_error(const Simplifier& simplifier, double bound, SimplifyResult& result,
                               const RunContext& context) {
  constexpr std::size_t kMaxTries = 7;
  const auto slot = [&](std::size_t i) {  // each try gets an equal share of the progress
    return context.phase(static_cast<double>(i) / (kMaxTries + 2), static_cast<double>(i + 1) / (kMaxTries + 2),
                         "search");
  };
  pipeline::CountSearch search{.most = simplifier.vertices(), .guess = 0, .max_tries = kMaxTries};
  const std::size_t first = std::max(search.least, share_of(kFirstGuess, simplifier.vertices()));
  search.guess = first;
  try {  // quadrics are cheap and tell the order of magnitude
    const RunContext part = slot(0);
    const SimplifiedMesh rough =
        simplifier.run(SimplifyMethod::Qslim, {.vertices = first, .faces = 0}, part.phase(0.0, 0.7, "collapse"));
    const double error = measure(simplifier, rough, part.phase(0.7, 1.0, "measure")).symmetric.max;
    search.guess = static_cast<std::size_t>(static_cast<double>(first) * std::clamp(error / bound, 0.01, 10.0));
  } catch (const TargetUnreachable&) {
    // The search finds out itself how far this goes.
  }
  std::optional<SimplifiedMesh> best;
  std::size_t tries = 0;
  const pipeline::FoundCount found = pipeline::find_count(bound, search, [&](std::size_t count) {
    ++tries;
    const RunContext part = slot(tries);
    SimplifiedMesh tried = simplifier.run({.vertices = count, .faces = 0}, part.phase(0.0, 0.7, "collapse"));
    const SurfaceDistance distance = measure(simplifier, tried, part.phase(0.7, 1.0, "measure"));
    const double error = distance.symmetric.max;
    if (error <= bound && (!best || tried.mesh.positions.size() < best->mesh.positions.size())) {
      best = std::move(tried);
      result.measured = distance;
    }
    return error;
  });
  result.runs = found.tries + 1;
  return std::move(*best);
}

// Vertices are input vertices bit for bit, or in the input's frame.
Geometry assemble(const GeometryView& input, const Surface& surface, const SimplifiedMesh& simplified,
                  Placement placement, const RunContext& context) {
  Geometry output;
  output.coordinate_type = input.rest().coordinate_type;
  output.viewpoint = input.viewpoint;
  output.comments = input.rest().comments;
  output.format = input.rest().format;
  output.triangles = simplified.mesh.triangles;
  output.positions.reserve(simplified.mesh.positions.size());
  for (std::size_t v = 0; v < simplified.mesh.positions.size(); ++v) {
    output.positions.push_back(placement == Placement::Input ? input.positions[simplified.source_vertex[v]]
                                                             : Vec3(simplified.mesh.positions[v] + surface.origin));
  }
  pipeline::transfer_attributes(input.rest(), surface, simplified, placement, output, context);
  return output;
}

void warn_of_oddities(const Simplifier& simplifier, std::size_t non_finite, SimplifyResult& result) {
  const auto note = [&](std::size_t count, std::string_view what) {
    if (count > 0) result.warnings.push_back(fmt::format("{} {}", count, what));
  };
  const MeshOddities& odd = simplifier.oddities();
  note(simplifier.surface().skipped_triangles, "faces at vertices that are not finite: left out");
  note(odd.degenerate_faces, "faces that name a vertex twice: left out");
  note(odd.duplicate_faces, "faces over the same vertices as another: left out");
  note(odd.reoriented_faces, "faces turned over to agree with their neighbours");
  note(odd.split_vertices, "vertices doubled where sheets only touch");
  note(odd.locked_vertices, "vertices kept where sheets meet and cannot be told apart");
  note(non_finite, "vertices without a finite position: left out");
  note(odd.unused_vertices - non_finite, "vertices in no face: left out");
}

void warn_of_noise(const SimplifyOptions& options, const std::optional<ShapeGuide>& guide, SimplifyResult& result) {
  if (!guide) return;
  result.noise = guide->noise();
  result.denoised = !guide->denoised().empty();
  if (!result.denoised) return;
  result.warnings.push_back(
      fmt::format("noise of {:.3g} ({:.2g} mean edge lengths): the error is measured against a denoised surface{}",
                  guide->noise(), guide->noise() / guide->mean_edge_length(),
                  options.ssim.placement == Placement::Optimal ? ", and the vertices lie on it"
                                                               : "; the vertices are the input's"));
}

SimplifyResult simplify_surface(const GeometryView& geometry, const SimplifySize& size, const SimplifyOptions& options,
                                const RunContext& context) {
  const Simplifier simplifier(geometry, options, context.phase(0.0, 0.3, "prepare"));
  SimplifyResult result;
  result.vertices_in = num_finite(geometry);
  result.surface_vertices = simplifier.vertices();
  result.faces_in = simplifier.faces();
  result.oddities = simplifier.oddities();
  warn_of_oddities(simplifier, geometry.size() - result.vertices_in, result);
  warn_of_noise(options, simplifier.guide(), result);
  const RunContext work = context.phase(0.3, 0.9, "collapse");
  SimplifiedMesh simplified = size.max_error ? search_by_error(simplifier, *size.max_error, result, work)
                                             : simplifier.run(target_of(size, simplifier, result), work);
  if (options.measure && !result.measured) {
    result.measured = measure(simplifier, simplified, context.phase(0.9, 0.95, "measure"));
  }
  result.geometry = assemble(geometry, simplifier.surface(), simplified, options.ssim.placement,
                             context.phase(0.95, 1.0, "carry attributes"));
  result.source_vertex = std::move(simplified.source_vertex);
  return result;
}

void refuse_on_cloud(const SimplifySize& size, const SimplifyOptions& options) {
  const auto refuse = [](std::string_view what, std::string_view why) {
    throw InvalidInput(
        fmt::format("{}: the input is a point cloud, which {}; expected --vertices or --ratio, for "
                    "which its points are sampled",
                    what, why));
  };
  if (size.faces) refuse("--faces", "has no faces");
  if (size.max_error) refuse("--max-error", "has no surface to measure the error on");
  if (options.measure) refuse("--measure", "has no surface to measure the error on");
  if (options.ssim.placement == Placement::Optimal)
    refuse("--placement optimal", "has no surface to place vertices on");
  if (options.method == SimplifyMethod::Qslim) refuse("--method qslim", "has no edges to collapse");
}

SimplifyResult sample_cloud(const GeometryView& geometry, const SimplifySize& size, const SimplifyOptions& options,
                            const RunContext& context) {
  refuse_on_cloud(size, options);
  const bool paper = options.preset == SimplifyPreset::Paper || options.method == SimplifyMethod::SsimPaper;
  SampleOptions sampling = sample_preset(paper ? Preset::Paper : Preset::Detail);
  sampling.local_weight = options.local_weight;
  sampling.fields = options.fields;
  SampleResult sampled =
      sample(geometry, {.count = size.vertices, .ratio = size.ratio, .spacing = {}}, sampling, context);
  std::sort(sampled.indices.begin(), sampled.indices.end());
  SimplifyResult result;
  result.geometry = select_points(geometry, sampled.indices);
  result.source_vertex = std::move(sampled.indices);
  result.sampled = true;
  result.vertices_in = sampled.usable;
  result.noise = sampled.noise;
  result.warnings.emplace_back(
      "the input is a point cloud without faces: its points were sampled, and no mesh was made");
  return result;
}

}  // namespace

void validate(const SimplifySize& size) {
  if (size.vertices.has_value() + size.faces.has_value() + size.ratio.has_value() + size.max_error.has_value() != 1) {
    throw InvalidInput("expected exactly one of --vertices, --faces, --ratio and --max-error");
  }
  if (size.vertices && *size.vertices == 0) throw InvalidInput("--vertices: 0 is out of range, expected at least 1");
  if (size.faces && *size.faces == 0) throw InvalidInput("--faces: 0 is out of range, expected at least 1");
  if (size.ratio && !(*size.ratio > 0.0 && *size.ratio <= 1.0)) {
    throw InvalidInput(fmt::format("--ratio: {:g} is out of range, expected more than 0 and at most 1", *size.ratio));
  }
  if (size.max_error && !(*size.max_error > 0.0 && std::isfinite(*size.max_error))) {
    throw InvalidInput(fmt::format("--max-error: {:g} is out of range, expected a positive length", *size.max_error));
  }
}

SimplifyOptions simplify_preset(SimplifyPreset preset, Placement placement) {
  const bool optimal = placement == Placement::Optimal;
  SimplifyOptions options;
  options.preset = preset;
  options.ssim.placement = placement;
  switch (preset) {
    case SimplifyPreset::Paper:
      if (optimal) throw InvalidInput("--placement optimal: the paper's method keeps input vertices, expected input");
      options.method = SimplifyMethod::SsimPaper;
      options.fields = fields_preset(Preset::Paper);
      break;
    case SimplifyPreset::Fast:
      options.ssim.pre_collapse = optimal ? 1.0 : 1.5;
      options.ssim.sweeps = optimal ? 3 : 2;
      options.ssim.sample_weight = 1.0;  // the prior costs as much as all the rest, and pays on noise and details only
      break;
    case SimplifyPreset::Best:
      options.ssim.pre_collapse = optimal ? 2.0 : 4.0;
      options.ssim.sweeps = 8;
      break;
    case SimplifyPreset::Detail:
      if (optimal) options.ssim.pre_collapse = 2.0;  // fitted vertices make good for what quadrics miss
      break;
  }
  return options;
}

SimplifyResult simplify(const GeometryView& geometry, const SimplifySize& size, const SimplifyOptions& options,
                        const RunContext& context) {
  validate(size);
  validate_options(options);
  if (options.method == SimplifyMethod::SsimPaper && options.ssim.placement == Placement::Optimal) {
    throw InvalidInput("--placement optimal: ssim-paper keeps input vertices, expected input");
  }
  SimplifyResult result = geometry.kind() == GeometryKind::Cloud ? sample_cloud(geometry, size, options, context)
                                                                 : simplify_surface(geometry, size, options, context);
  context.check();
  context.report(1.0, "done");
  return result;
}

}  // namespace shapelight
