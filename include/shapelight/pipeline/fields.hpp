#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/denoise/non_local_means.hpp"
#include "shapelight/features/curvature.hpp"
#include "shapelight/features/shape_index.hpp"
#include "shapelight/features/surface_variation.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/retinex/retinex.hpp"
#include "shapelight/segment/segmentation.hpp"

namespace shapelight {

/// Detail: our default. Fast: detail without non-local means and Retinex. Paper: the literal paper, every step.
enum class Preset : std::uint8_t { Detail, Fast, Paper };

[[nodiscard]] constexpr auto enum_names(Preset) {
  return std::array<std::pair<Preset, std::string_view>, 3>{
      {{Preset::Detail, "detail"}, {Preset::Fast, "fast"}, {Preset::Paper, "paper"}}};
}

/// What compute_fields() does; start from fields_preset().
struct FieldsOptions {
  bool adaptive = true;  ///< choose curvature method, passes and denoising by the kind of input and its noise
  bool denoise = true;   ///< non-local means on the shape index; with `adaptive` only when there is noise
  bool retinex = true;   ///< illumination and reflectance
  bool segment = true;   ///< segments of the reflectance
  GraphOptions graph;
  CurvatureOptions curvature;
  ShapeIndexOptions shape_index;
  SurfaceVariationOptions variation;
  NonLocalMeansOptions non_local_means;
  RetinexOptions retinex_options;
  SegmentationOptions segmentation;

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"adaptive", "", "Choose curvature method, passes and denoising by the input and its noise.", 0, 1},
          o.adaptive);
    visit(OptionInfo{"denoise", "", "Non-local means on the shape index.", 0, 1}, o.denoise);
    visit(OptionInfo{"retinex", "", "Split the shape index into illumination and reflectance.", 0, 1}, o.retinex);
    visit(OptionInfo{"segment", "", "Cut the reflectance into segments.", 0, 1}, o.segment);
    GraphOptions::describe(o.graph, visit);
    CurvatureOptions::describe(o.curvature, visit);
    ShapeIndexOptions::describe(o.shape_index, visit);
    SurfaceVariationOptions::describe(o.variation, visit);
    NonLocalMeansOptions::describe(o.non_local_means, visit);
    RetinexOptions::describe(o.retinex_options, visit);
    SegmentationOptions::describe(o.segmentation, visit);
  }
};

[[nodiscard]] FieldsOptions fields_preset(Preset preset);

/// Per vertex of a SurfaceGraph; arrays of stages that were switched off are empty.
struct SurfaceFields {
  double noise = 0.0;                                          ///< sigma, [input length unit]
  bool denoised = false;                                       ///< non-local means ran
  CurvatureMethod curvature_method = CurvatureMethod::Taubin;  ///< the one used
  int curvature_passes = 0;                                    ///< the number used
  std::vector<double> k1, k2;             ///< [1 / input length unit] principal curvatures, convex positive
  std::vector<double> curvedness;         ///< [1 / input length unit]
  std::vector<double> shape_index;        ///< [1] in [-1, 1], denoised when asked for
  std::vector<double> surface_variation;  ///< [1] in [0, 1/3]
  std::vector<double> illumination;       ///< [1] in [0, 1]
  std::vector<double> reflectance;        ///< [1] in [-log 2, log 2]
  std::vector<std::uint32_t> segment;     ///< labels from 0
  std::size_t num_segments = 0;
  std::vector<double> importance;  ///< [1] density of samples that the shape asks for, see sampling_density()
};

/// Runs the stages over a graph: noise, curvature, shape index, non-local means, Retinex, segmentation, importance
/// (paper, sections II.A to II.C). `kind` steers the adaptive choices only.
/// Throws InvalidInput (option out of range), Cancelled. Cost: the sum of the stages.
[[nodiscard]] SurfaceFields compute_fields(const SurfaceGraph& graph, GeometryKind kind, const FieldsOptions& options,
                                           const RunContext& context = {});

struct PointFields {
  AttributeTable attributes;  ///< shape_index, curvedness, illumination, reflectance, segment, importance
  double noise = 0.0;  ///< sigma, [input length unit]
  double mean_edge_length = 0.0;  ///< h, [input length unit]
  bool denoised = false;
  CurvatureMethod curvature_method = CurvatureMethod::Taubin;
  std::size_t num_segments = 0;
  GraphDiagnostics diagnostics;
};

/// The fields per point of the input, float32 and int32 as they are written to files. A point without a vertex (not
/// finite) gets NaN and the segment -1; a duplicate has the values of the point it repeats.
/// Throws InvalidInput (option out of range), Cancelled. Cost: the sum of the stages.
[[nodiscard]] PointFields point_fields(const GeometryView& geometry, const FieldsOptions& options,
                                       const RunContext& context = {});

}  // namespace shapelight
