#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight {

/// Two places that may be one, with the normals that would then agree.
struct PlacePair {
  Vec3 source, target;                ///< [input length unit]
  Vec3 source_normal, target_normal;  ///< unit
};

/// Which pairs can hold under one and the same rigid motion: those that lie equally far from each other in both scans,
/// to within the tolerance, with equal angles between the normals, and far enough apart for that to mean anything.
/// Symmetric, n x n bits.
class CompatibilityGraph {
 public:
  CompatibilityGraph(std::span<const PlacePair> pairs, double tolerance, const RunContext& context);

  [[nodiscard]] std::size_t size() const { return size_; }
  /// How many pairs are compatible with i.
  [[nodiscard]] int degree(std::size_t i) const { return common(i, i); }
  /// How many pairs are compatible with both i and j: the second-order compatibility of i and j where they are
  /// compatible themselves (Chen et al. 2022, eq. 4).
  [[nodiscard]] int common(std::size_t i, std::size_t j) const;

  /// visit(j) for every pair that is compatible with i, ascending.
  template <class Visit>
  void for_each_compatible(std::size_t i, Visit&& visit) const {
    for (std::size_t w = 0; w < words_; ++w) {
      for (std::uint64_t word = bits_[i * words_ + w]; word != 0; word &= word - 1) {
        visit(64 * w + static_cast<std::size_t>(std::countr_zero(word)));
      }
    }
  }

 private:
  std::size_t size_;
  std::size_t words_;  // per row
  std::vector<std::uint64_t> bits_;
};

}  // namespace shapelight
