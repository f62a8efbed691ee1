#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "shapelight/core/types.hpp"

namespace shapelight::simplification {

/// A priority queue that is exact to an eighth of an octave: buckets by the leading bits of a float key, which sort
/// like the key itself. A round is a whole bucket in order of arrival; nothing is ever moved, and because the next
/// entries are known, their data can be fetched ahead. Entries are never removed: a vertex whose key has changed since
/// makes its older entries stale, which the caller sees from the key.
class BucketQueue {
 public:
  struct Entry {
    float key;
    Index id;
  };

  /// Pre: key >= 0. What is cheaper than the current round joins the next round.
  void push(float key, Index id) { buckets_[std::max(bucket_of(key), current_)].push_back({key, id}); }

  /// True when an entry of this key need not wait for a later bucket.
  [[nodiscard]] bool is_due(float key) const { return bucket_of(key) <= current_; }

  /// The next round; empty when nothing is queued. Valid until the next call.
  [[nodiscard]] const std::vector<Entry>& next_round() {
    round_.clear();
    while (current_ + 1 < kBuckets && buckets_[current_].empty()) ++current_;
    round_.swap(buckets_[current_]);
    return round_;
  }

  /// Starts again from the cheapest bucket. Pre: nothing is queued.
  void rewind() { current_ = 0; }

 private:
  static constexpr std::size_t kDroppedBits = 20;  // leaves sign, exponent and three bits: eight buckets per octave
  static constexpr std::size_t kBuckets = (0x7f800000u >> kDroppedBits) + 1;
  static std::size_t bucket_of(float key) { return std::bit_cast<std::uint32_t>(key) >> kDroppedBits; }

  std::array<std::vector<Entry>, kBuckets> buckets_;
  std::vector<Entry> round_;
  std::size_t current_ = 0;
};

}  // namespace shapelight::simplification
