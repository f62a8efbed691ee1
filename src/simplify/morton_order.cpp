#include "simplify/morton_order.hpp"

#include <algorithm>
#include <array>

#include "core/parallel.hpp"

namespace shapelight::simplification {
namespace {

// Ten bits spread out to every third place.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | (x << 16)) & 0x030000ffu;
  x = (x | (x << 8)) & 0x0300f00fu;
  x = (x | (x << 4)) & 0x030c30c3u;
  return (x | (x << 2)) & 0x09249249u;
}

struct Code {
  std::uint32_t code;
  Index id;
};

}  // namespace

std::vector<Index> morton_order(std::span<const Vec3> positions, const Vec3& low, double scale,
                                const RunContext& context) {
  constexpr int kBits = 10;  // per axis, and per pass of the radix sort
  constexpr std::size_t kDigits = std::size_t{1} << kBits;
  std::vector<Code> codes(positions.size()), sorted(positions.size());
  parallel::for_chunks(context, positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t code = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double cell = scale * (positions[i][axis] - low[axis]) * kDigits;
        code |= spread_bits(static_cast<std::uint32_t>(std::clamp(cell, 0.0, kDigits - 1.0))) << axis;
      }
      codes[i] = {code, static_cast<Index>(i)};
    }
  });
  for (int pass = 0; pass < 3; ++pass) {
    const auto digit = [&](const Code& c) { return (c.code >> (kBits * pass)) % kDigits; };
    std::array<Index, kDigits + 1> next{};
    for (const Code& c : codes) ++next[digit(c) + 1];
    for (std::size_t d = 0; d < kDigits; ++d) next[d + 1] += next[d];
    for (const Code& c : codes) sorted[next[digit(c)]++] = c;
    codes.swap(sorted);
  }
  std::vector<Index> order(codes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = codes[i].id;
  return order;
}

}  // namespace shapelight::simplification
