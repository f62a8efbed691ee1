#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/metrics/surface_distance.hpp"
#include "shapelight/pipeline/fields.hpp"
#include "shapelight/simplify/ssim.hpp"

namespace shapelight {

enum class SimplifyMethod : std::uint8_t { Ssim, SsimPaper, Qslim };

[[nodiscard]] constexpr auto enum_names(SimplifyMethod) {
  return std::array<std::pair<SimplifyMethod, std::string_view>, 3>{
      {{SimplifyMethod::Ssim, "ssim"}, {SimplifyMethod::SsimPaper, "ssim-paper"}, {SimplifyMethod::Qslim, "qslim"}}};
}

/// Detail: our default. Fast: less measured collapse, fewer sweeps. Best: more of both. Paper: the literal paper.
enum class SimplifyPreset : std::uint8_t { Detail, Fast, Best, Paper };

[[nodiscard]] constexpr auto enum_names(SimplifyPreset) {
  return std::array<std::pair<SimplifyPreset, std::string_view>, 4>{{{SimplifyPreset::Detail, "detail"},
                                                                     {SimplifyPreset::Fast, "fast"},
                                                                     {SimplifyPreset::Best, "best"},
                                                                     {SimplifyPreset::Paper, "paper"}}};
}

/// How far to simplify: exactly one member is set.
struct SimplifySize {
  std::optional<std::uint64_t> vertices;  ///< [vertices] reached exactly
  std::optional<std::uint64_t> faces;     ///< [faces] reached, or missed by one
  std::optional<double> ratio;            ///< [1] share of the input's finite vertices to keep, in (0, 1]; rounded
  std::optional<double> max_error;        ///< [input length unit] largest distance between input and result, both ways
};

/// Throws InvalidInput unless exactly one member is set and in range.
void validate(const SimplifySize& size);

/// What simplify() does; start from simplify_preset().
struct SimplifyOptions {
  SimplifyPreset preset = SimplifyPreset::Detail;  ///< Paper: the paper's sampler in place of ours
  SimplifyMethod method = SimplifyMethod::Ssim;
  SsimOptions ssim;               ///< qslim reads its placement and its boundary_weight
  double local_weight = 0.65;     ///< [1] T of the samples that guide ssim and ssim-paper
  double noise_threshold = 0.1;  ///< [mean edge lengths] more noise: ssim measures against a denoised surface
  bool measure = false;           ///< measure the distance between input and result
  FieldsOptions fields;           ///< of the samples

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"method", "", "How the mesh is simplified.", 0, 0}, o.method);
    SsimOptions::describe(o.ssim, visit);
    visit(
        OptionInfo{"local-weight", "1", "Share of the guiding samples chosen for local detail (the paper's T).", 0, 1},
        o.local_weight);
    visit(OptionInfo{"noise-threshold", "mean edge lengths",
                     "More noise than this: the error is measured against a denoised surface.", 0, 1e6},
          o.noise_threshold);
    visit(OptionInfo{"measure", "", "Measure and report the distance between input and result.", 0, 1}, o.measure);
    FieldsOptions::describe(o.fields, visit);
  }
};

/// The preset's options for a placement. Throws InvalidInput for SimplifyPreset::Paper with Placement::Optimal.
[[nodiscard]] SimplifyOptions simplify_preset(SimplifyPreset preset, Placement placement = Placement::Input);

struct SimplifyResult {
  Geometry geometry;                 ///< a mesh with the input's attributes; a cloud when the input was one
  std::vector<Index> source_vertex;  ///< per vertex: the input vertex it is, or (Placement::Optimal) descends from
  bool sampled = false;              ///< the input was a cloud: its points were sampled
  std::size_t vertices_in = 0;       ///< finite ones of the input: what ratios are shares of
  std::size_t surface_vertices = 0;  ///< of those in faces
  std::size_t faces_in = 0;          ///< faces of the surface; of a range image, what its grid was cut into
  double noise = 0.0;                ///< sigma, [input length unit]; of the methods that look at it
  bool denoised = false;             ///< the error was measured against a denoised surface
  MeshOddities oddities;
  std::optional<SurfaceDistance>
      measured;                       ///< input to result; with SimplifySize::max_error or SimplifyOptions::measure
  std::size_t runs = 1;               ///< simplifications that the search for max_error took
  std::vector<std::string> warnings;  ///< odd but usable things met, for people
};

/// Fewer vertices, the same shape (paper, section III.A). A range image is cut into triangles first. A raw cloud has no
/// faces to simplify: sample() chooses its points, `sampled` says so, and faces, max_error, Placement::Optimal and
/// qslim are refused. Attributes follow: those of the source vertex (Placement::Input) or, interpolated by type, those
/// at the closest point of the input surface; triangles take those of the closest input triangle; texture coordinates
/// keep their seams. `max_error` finds the coarsest result by bisection of measured distances, in at most nine runs.
/// Post: counts as asked for; no face repeats a vertex or another face; no hole, handle, non-manifold edge or turned
/// face that the input lacked; Placement::Input returns input vertices only, bit for bit.
/// Throws InvalidInput, TargetUnreachable (reachable(): faces when faces were asked for, else vertices),
/// PostconditionFailed, Cancelled. Same result for any RunContext.
[[nodiscard]] SimplifyResult simplify(const GeometryView& geometry, const SimplifySize& size,
                                      const SimplifyOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
