#pragma once

#include <span>
#include <vector>

#include "pipeline/simplify_surface.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/pipeline/simplify.hpp"

namespace shapelight::pipeline {

/// What the shape says before anything is simplified: its samples, its noise and, under noise, the surface without it.
/// Built once; each target takes its own samples.
class ShapeGuide {
 public:
  ShapeGuide(const GeometryView& geometry, const Surface& surface, const SimplifyOptions& options,
             const RunContext& context);

  /// The samples of that many vertices, input indices, ascending; only vertices of the surface.
  [[nodiscard]] std::vector<Index> samples(std::size_t count, const RunContext& context) const;
  [[nodiscard]] std::span<const Vec3> denoised() const { return denoised_; }  ///< per point; empty: not noisy
  [[nodiscard]] double noise() const { return fields_.noise; }                ///< [input length unit]
  [[nodiscard]] double mean_edge_length() const { return graph_.mean_edge_length; }

 private:
  SurfaceGraph graph_;
  SurfaceFields fields_;
  std::vector<Index> candidates_;  // graph vertices
  std::vector<Vec3> denoised_;
  bool paper_;
  double local_weight_;
};

}  // namespace shapelight::pipeline
