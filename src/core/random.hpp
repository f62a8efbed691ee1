#pragma once

#include <cstdint>

namespace shapelight {

/// 64 well-mixed bits, a pure function of its arguments (SplitMix64 finaliser): no state, so no order to depend on.
[[nodiscard]] constexpr std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t id) {
  auto mix = [](std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  };
  return mix(mix(mix(seed) ^ stream) ^ id);
}

/// Uniform in [0, 1), 53 bits.
[[nodiscard]] constexpr double random01(std::uint64_t seed, std::uint64_t stream, std::uint64_t id) {
  return static_cast<double>(random_bits(seed, stream, id) >> 11) * 0x1.0p-53;
}

}  // namespace shapelight
