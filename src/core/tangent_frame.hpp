#pragma once

#include <cmath>

#include "shapelight/core/types.hpp"

namespace shapelight {

/// Two unit vectors that form a right-handed frame with a unit normal.
struct TangentFrame {
  Vec3 x, y;
};

/// Any frame of a unit normal; continuous except where normal.z changes sign (Duff et al. 2017).
[[nodiscard]] inline TangentFrame tangent_frame(const Vec3& normal) {
  const double sign = std::copysign(1.0, normal.z());
  const double a = -1.0 / (sign + normal.z());
  const double b = normal.x() * normal.y() * a;
  return {Vec3(1.0 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x()),
          Vec3(b, sign + normal.y() * normal.y() * a, -normal.y())};
}

}  // namespace shapelight
