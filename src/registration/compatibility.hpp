#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "registration/match_descriptors.hpp"
#include "shapelight/core/run_context.hpp"

namespace shapelight {

/// Which matches can hold under one and the same rigid motion: n x n bits.
class CompatibilityGraph {
 public:
  CompatibilityGraph(const DescribedPoints& source, const DescribedPoints& target, std::span<const Match> matches,
                     double tolerance, const RunContext& context);
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<const std::uint64_t> row(std::size_t i) const { return {bits_.data() + i * words_, words_}; }
  /// How many matches are compatible with both i and j.
  [[nodiscard]] int common(std::size_t i, std::size_t j) const;

  template <class Visit>
  void for_each(std::size_t i, Visit&& visit) const {
    for (std::size_t w = 0; w < words_; ++w) {
      for (std::uint64_t word = bits_[i * words_ + w]; word != 0; word &= word - 1) {
        visit(w * 64 + static_cast<std::size_t>(std::countr_zero(word)));
      }
    }
  }

 private:
  std::size_t size_, words_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace shapelight
