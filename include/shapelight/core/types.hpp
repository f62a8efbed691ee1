#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>

/// Keeps the points that carry a shape: sampling of meshes, range images and point clouds.
namespace shapelight {

using Vec3 = Eigen::Vector3d;  ///< position, direction or normal; double so that large offsets (UTM) stay exact
using Index = std::uint32_t;   ///< index of a point, vertex or pixel; at most kMaxPoints of them

/// Marks "no such element" wherever an Index is expected.
inline constexpr Index kNoIndex = std::numeric_limits<Index>::max();
/// Largest number of points that one geometry holds.
inline constexpr std::uint64_t kMaxPoints = kNoIndex - 1;

using RigidTransform = Eigen::Isometry3d;  ///< x -> R x + t; named by its frames: p_a = T_a_b p_b
using Triangle = std::array<Index, 3>;     ///< vertex indices, counter-clockwise seen from outside

}  // namespace shapelight
