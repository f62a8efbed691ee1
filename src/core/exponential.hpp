#pragma once

#include <bit>
#include <cstdint>

namespace shapelight {

/// exp(-x) for x in [0, 80], relative error below 3e-7. Branch-free, so that loops over it vectorise, and made of
/// exactly rounded operations only, so that every machine gives the same bits.
[[nodiscard]] inline float exp_minus(float x) {
  const float power = x * -1.44269504f;
  const auto whole = static_cast<std::int32_t>(power - 0.5f);
  const float r = (power - static_cast<float>(whole)) * 0.69314718f;  // in [-0.35, 0.35]
  const float series =
      1.0f +
      r * (1.0f + r * (0.5f + r * (1.66666667e-1f + r * (4.16666667e-2f + r * (8.33333333e-3f + r * 1.38888889e-3f)))));
  return series * std::bit_cast<float>((whole + 127) << 23);
}

}  // namespace shapelight
