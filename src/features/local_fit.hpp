#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "core/tangent_frame.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Symmetric 2x2 tensor in a tangent frame: mean I + [[re, im], [im, -re]]. Turning the frame by an angle turns
/// (re, im) by twice that angle and leaves the mean alone.
struct TangentTensor {
  double mean = 0.0, re = 0.0, im = 0.0;
  bool defined = false;
};

/// The nearest vertices of the 2-ring. One instance per chunk of work.
class NearestOfRings {
 public:
  explicit NearestOfRings(const SurfaceGraph& graph) : graph_(&graph), rings_(graph) {}
  /// At most `count` vertices beside `center`, which is left out; no particular order, ties by index.
  std::span<const Index> find(Index center, std::size_t count);

 private:
  const SurfaceGraph* graph_;
  RingCollector rings_;
  std::vector<std::pair<double, Index>> by_distance_;
  std::vector<Index> nearest_;
};

/// z = c + gx x + gy y + (a x^2 + 2 b x y + d y^2) / 2 over the frame of a vertex's normal.
struct QuadricFit {
  Eigen::Matrix<double, 6, 1> coefficients;  ///< c, gx, gy, a, b, d; lengths in units of `scale`
  double scale = 1.0;                        ///< [input length unit] root mean square distance of the vertices
  double leverage = 1.0;                     ///< weight of the centre's own height in c, unit weights only
};

enum class FitWeight { Unit, Gaussian };

/// Least-squares quadric through `center` and `others`. Pre: the normal of center is not zero; others not empty.
[[nodiscard]] QuadricFit fit_quadric(const SurfaceGraph& graph, Index center, const TangentFrame& frame,
                                     std::span<const Index> others, FitWeight weight);

/// Shape operator I^-1/2 II I^-1/2 of a quadric at its centre, convex positive.
[[nodiscard]] TangentTensor shape_operator(const QuadricFit& fit);

/// Least-squares dn = S dx over `others`; undefined when they do not span the plane.
[[nodiscard]] TangentTensor fit_normal_field(const SurfaceGraph& graph, Index center, const TangentFrame& frame,
                                             std::span<const Index> others);

}  // namespace shapelight
