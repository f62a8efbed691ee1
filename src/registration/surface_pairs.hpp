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

}  // namespace shapelight::registration
