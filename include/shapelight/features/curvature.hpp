#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Conventions, fixed here for the whole library: curvature is positive where the surface is convex seen from the side
/// its normals point to (a sphere of radius r with outward normals has k1 = k2 = 1 / r), k1 >= k2, the mean curvature
/// is half their sum.
struct Curvatures {
  std::vector<double> k1;        ///< n: [1 / input length unit] larger principal curvature
  std::vector<double> k2;        ///< n: [1 / input length unit] smaller principal curvature
  std::vector<Vec3> direction1;  ///< n: unit tangent along k1, sign arbitrary; zero where the curvature is undefined
};

enum class CurvatureMethod : std::uint8_t { Taubin, Quadric, NormalField };

[[nodiscard]] constexpr auto enum_names(CurvatureMethod) {
  return std::array<std::pair<CurvatureMethod, std::string_view>, 3>{{{CurvatureMethod::Taubin, "taubin"},
                                                                      {CurvatureMethod::Quadric, "quadric"},
                                                                      {CurvatureMethod::NormalField, "normal-field"}}};
}

/// Parameters of estimate_curvatures().
struct CurvatureOptions {
  CurvatureMethod method = CurvatureMethod::Taubin;  ///< Taubin for meshes, the other two for raw clouds and noise
  int smoothing_passes = 1;                          ///< [1] averages of the tensor over the 1-ring
  int neighbors = 20;                                ///< [points] support of quadric and normal-field

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"curvature-method", "", "How curvature is estimated.", 0, 0}, o.method);
    visit(OptionInfo{"curvature-passes", "1", "Averages of the curvature tensor over the 1-ring.", 0, 100},
          o.smoothing_passes);
    visit(OptionInfo{"curvature-neighbors", "points", "Support of the quadric and of the normal field.", 6, 60},
          o.neighbors);
  }
};

/// Principal curvatures at every vertex: the ingredient of eq. 2 of the paper.
///
/// - Taubin: directional curvatures -2 n.(v_j - v_i) / |v_j - v_i|^2 of the edges, weighted by the surface they stand
///   for, and the tensor that fits them. Where the edges point evenly round the vertex this is Taubin's k1 = 3 m1 - m2,
///   k2 = 3 m2 - m1 in closed form; uneven rings, which bias his means, are fitted by least squares. Wants little
///   noise.
/// - Quadric: least-squares z = c + gx x + gy y + (a x^2 + 2 b x y + d y^2) / 2 over the nearest `neighbors` vertices
/// of
///   the 2-ring, Gaussian weights, shape operator I^-1/2 II I^-1/2. For clean clouds.
/// - NormalField: least-squares dn = S dx with symmetric S over the same vertices, weight max(0, n.n')^2. For noise.
///
/// Then `smoothing_passes` times the tensor becomes the mean over the vertex and its 1-ring, every tensor turned by the
/// smallest rotation between the normals, weight area max(0, n.n')^2: one pass suits clean input, two to four noise.
/// Pre:   as SurfaceGraph promises.
/// Post:  k1 >= k2, finite; zero with a zero direction where the normal is zero or nothing is near.
/// Throws InvalidInput (option out of range), Cancelled.
/// Cost:  O(edges) for Taubin and each pass; O(n neighbors) for the others. 56 n bytes beyond the result.
/// Support: 1 (Taubin) or 2 rings, plus one per pass.
[[nodiscard]] Curvatures estimate_curvatures(const SurfaceGraph& graph, const CurvatureOptions& options = {},
                                             const RunContext& context = {});

/// Koenderink's curvedness sqrt((k1^2 + k2^2) / 2): how much the surface bends, whatever its shape.
[[nodiscard]] inline double curvedness(double k1, double k2) { return std::sqrt(0.5 * (k1 * k1 + k2 * k2)); }

}  // namespace shapelight
