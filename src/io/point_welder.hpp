#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "core/random.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight::io {

/// Gives points with exactly the same coordinates one index, in the order of first appearance: an open-addressing
/// hash table over a list of points that it appends to. Pre: coordinates are not NaN, fewer than kMaxPoints points.
class PointWelder {
 public:
  explicit PointWelder(std::vector<Vec3>& points) : points_(points), slots_(64, kNoIndex) {}

  Index add(const Vec3& point) {
    if (2 * points_.size() >= slots_.size()) grow();
    const std::size_t slot = find_slot(point);
    if (slots_[slot] == kNoIndex) {
      slots_[slot] = static_cast<Index>(points_.size());
      points_.push_back(point);
    }
    return slots_[slot];
  }

 private:
  // The slot of an equal point, or the free one where it belongs.
  [[nodiscard]] std::size_t find_slot(const Vec3& point) const {
    // Adding zero makes -0 and +0, which compare equal, hash alike.
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = random_bits(bits(point.x()), bits(point.y()), bits(point.z())) & mask;
    while (slots_[slot] != kNoIndex && points_[slots_[slot]] != point) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), kNoIndex);
    for (std::size_t i = 0; i < points_.size(); ++i) slots_[find_slot(points_[i])] = static_cast<Index>(i);
  }

  std::vector<Vec3>& points_;
  std::vector<Index> slots_;
};

}  // namespace shapelight::io
