#include "registration/compatibility.hpp"

#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "core/vectorize.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kChunk = 64;
constexpr float kMinDistanceSq = 4.0F;  // [tolerances squared] closer pairs agree whatever the motion
constexpr float kMaxTurnSq = 0.1225F;   // 0.35 squared: difference of the cosines between normals
constexpr int kColumns = 12;
using Columns = std::array<std::vector<float>, kColumns>;

/// Coordinates by column, in tolerances: source, target, source normal, target normal.
Columns columns_of(std::span<const PlacePair> pairs, double tolerance) {
  Columns columns;
  for (auto& column : columns) column.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      columns[axis][i] = static_cast<float>(pairs[i].source[axis] / tolerance);
      columns[axis + 3][i] = static_cast<float>(pairs[i].target[axis] / tolerance);
      columns[axis + 6][i] = static_cast<float>(pairs[i].source_normal[axis]);
      columns[axis + 9][i] = static_cast<float>(pairs[i].target_normal[axis]);
    }
  }
  return columns;
}

SHAPELIGHT_VECTORIZE void compatible_with(const std::array<const float*, kColumns>& column, std::size_t i,
                                          std::size_t count, std::uint8_t* compatible) {
  std::array<float, kColumns> own{};
  for (int c = 0; c < kColumns; ++c) own[c] = column[c][i];
  for (std::size_t j = 0; j < count; ++j) {
    float source_sq = 0.0F;
    float target_sq = 0.0F;
    float source_cosine = 0.0F;
    float target_cosine = 0.0F;
    for (int axis = 0; axis < 3; ++axis) {
      const float source = column[axis][j] - own[axis];
      const float target = column[axis + 3][j] - own[axis + 3];
      source_sq += source * source;
      target_sq += target * target;
      source_cosine += column[axis + 6][j] * own[axis + 6];
      target_cosine += column[axis + 9][j] * own[axis + 9];
    }
    const float stretch = std::sqrt(source_sq) - std::sqrt(target_sq);
    const float turn = source_cosine - target_cosine;
    compatible[j] = (stretch * stretch < 1.0F) & (turn * turn < kMaxTurnSq) & (source_sq > kMinDistanceSq) &
                    (target_sq > kMinDistanceSq);
  }
}

SHAPELIGHT_VECTORIZE int count_common(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) {
  int count = 0;
  for (std::size_t w = 0; w < words; ++w) count += std::popcount(a[w] & b[w]);
  return count;
}

}  // namespace

CompatibilityGraph::CompatibilityGraph(std::span<const PlacePair> pairs, double tolerance, const RunContext& context)
    : size_(pairs.size()), words_((size_ + 63) / 64), bits_(size_ * words_, 0) {
  const Columns columns = columns_of(pairs, tolerance);
  std::array<const float*, kColumns> column{};
  for (int c = 0; c < kColumns; ++c) column[c] = columns[c].data();
  parallel::for_chunks(
      context, size_,
      [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint8_t> compatible(size_);
        for (std::size_t i = begin; i < end; ++i) {
          compatible_with(column, i, size_, compatible.data());
          for (std::size_t j = 0; j < size_; ++j) {
            bits_[i * words_ + j / 64] |= std::uint64_t{compatible[j]} << (j % 64);
          }
        }
      },
      kChunk);
}

int CompatibilityGraph::common(std::size_t i, std::size_t j) const {
  return count_common(&bits_[i * words_], &bits_[j * words_], words_);
}

}  // namespace shapelight
