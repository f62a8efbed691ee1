#include "registration/compatibility.hpp"

#include <array>
#include <bit>
#include <cmath>

#include "core/parallel.hpp"
#include "core/vectorize.hpp"
#include "registration/tune.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kChunk = 64;
/// Coordinates and normals of both ends of all matches, in units of the tolerance.
struct Ends {
  std::array<std::vector<float>, 12> value;
};

SHAPELIGHT_VECTORIZE void compatible_with(const std::array<const float*, 12>& v, std::size_t i, std::size_t n,
                                          float normals, std::uint8_t* yes) {
  float own[12];
  for (int a = 0; a < 12; ++a) own[a] = v[a][i];
  for (std::size_t j = 0; j < n; ++j) {
    float p = 0, q = 0, m = 0, o = 0;
    for (int a = 0; a < 3; ++a) {
      const float dp = v[a][j] - own[a];
      const float dq = v[a + 3][j] - own[a + 3];
      p += dp * dp;
      q += dq * dq;
      m += v[a + 6][j] * own[a + 6];
      o += v[a + 9][j] * own[a + 9];
    }
    const float stretch = std::sqrt(p) - std::sqrt(q);
    const float turn = m - o;
    yes[j] = (stretch * stretch < 1.0F) & (turn * turn < normals) & (p > 4.0F) & (q > 4.0F);
  }
}

}  // namespace

CompatibilityGraph::CompatibilityGraph(const DescribedPoints& source, const DescribedPoints& target,
                                       std::span<const Match> matches, double tolerance, const RunContext& context)
    : size_(matches.size()), words_((size_ + 63) / 64), bits_(size_ * words_, 0) {
  std::array<std::vector<float>, 12> columns;
  for (auto& column : columns) column.resize(words_ * 64, 1e9F);
  for (std::size_t i = 0; i < size_; ++i) {
    const Match& m = matches[i];
    for (int a = 0; a < 3; ++a) {
      columns[a][i] = static_cast<float>(source.position[m.source][a] / tolerance);
      columns[a + 3][i] = static_cast<float>(target.position[m.target][a] / tolerance);
      columns[a + 6][i] = static_cast<float>(source.normal[m.source][a]);
      columns[a + 9][i] = static_cast<float>(m.turned ? -target.normal[m.target][a] : target.normal[m.target][a]);
    }
  }
  std::array<const float*, 12> v;
  for (int a = 0; a < 12; ++a) v[a] = columns[a].data();
  parallel::for_chunks(
      context, size_,
      [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint8_t> yes(words_ * 64);
        for (std::size_t i = begin; i < end; ++i) {
          compatible_with(v, i, size_, float(tune::NCOS * tune::NCOS), yes.data());
          for (std::size_t j = 0; j < size_; ++j) bits_[i * words_ + j / 64] |= std::uint64_t{yes[j]} << (j % 64);
        }
      },
      kChunk);
}

int CompatibilityGraph::common(std::size_t i, std::size_t j) const {
  int count = 0;
  for (std::size_t w = 0; w < words_; ++w) count += std::popcount(bits_[i * words_ + w] & bits_[j * words_ + w]);
  return count;
}

}  // namespace shapelight
