#pragma once

#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"

namespace shapelight::registration {

/// A point of one cloud and its nearest in the other, once they are brought together.
struct SurfacePair {
  double distance = 0.0;  ///< [length]
  double height = 0.0;    ///< [length] over the other's tangent plane
  double cosine = 0.0;    ///< [1] between the normals; 0 when one is undefined
  Index nearest = kNoIndex;
};

/// One pair for each of the `chosen` points of `from`. Pre: both have normals.
[[nodiscard]] std::vector<SurfacePair> pair_surfaces(const RegistrationCloud& from, std::span<const Index> chosen,
                                                     const RegistrationCloud& to, const RigidTransform& T_to_from,
                                                     const RunContext& context);
/// The same for all points.
[[nodiscard]] std::vector<SurfacePair> pair_surfaces(const RegistrationCloud& from, const RegistrationCloud& to,
                                                     const RigidTransform& T_to_from, const RunContext& context);

/// Without both sensors' places the side that a normal points to says nothing: cosines become absolute values.
void forget_sides(std::span<SurfacePair> pairs, const RegistrationCloud& a, const RegistrationCloud& b);

/// Do these two lie on the same side of a surface, the one within `gate` of the other?
[[nodiscard]] inline bool is_overlap(const SurfacePair& pair, double gate) {
  constexpr double kAgree = 0.7;  // 45 degrees
  return pair.distance <= gate && pair.cosine >= kAgree;
}

/// How close two surfaces come where they are the same.
struct SurfaceGate {
  double width = 0.0;     ///< [length]
  double residual = 0.0;  ///< [length] 1.4826 times the median of |height| within
  double contrast = 0.0;  ///< [1] density of pairs within over that within the widest gate; 1: it could not shrink
};

/// Starts at `widest` and shrinks to six residuals, and never below `narrowest`, as long as residuals shrink with it:
/// on a right pose they do, down to noise and point spacing; on a wrong one heights fill any gate evenly.
[[nodiscard]] SurfaceGate find_gate(std::span<const SurfacePair> pairs, double widest, double narrowest);

/// The widest and the narrowest gate for two scans: 3 % of the smaller diagonal, 3 of the wider spacings.
[[nodiscard]] double widest_gate(const RegistrationCloud& a, const RegistrationCloud& b);
[[nodiscard]] double narrowest_gate(const RegistrationCloud& a, const RegistrationCloud& b);

}  // namespace shapelight::registration
