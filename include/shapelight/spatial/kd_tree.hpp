#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"

namespace shapelight {

/// A point found by a query.
struct Neighbor {
  double distance_sq = 0.0;  ///< [input length unit squared]
  Index index = kNoIndex;    ///< into the points that the tree was built from
  friend bool operator<(const Neighbor& a, const Neighbor& b) {
    return a.distance_sq < b.distance_sq || (a.distance_sq == b.distance_sq && a.index < b.index);
  }
};

/// Static kd-tree over points; exact queries in double precision.
/// Pre: points finite. Queries are const and safe from any number of threads. Answers are sorted by (distance, index),
/// so ties do not depend on the shape of the tree. Keeps its own copy of the points.
/// Cost: building O(n log n), a query O(k + log n); about 45 bytes per point.
class KdTree {
 public:
  /// Throws Cancelled.
  explicit KdTree(std::span<const Vec3> points, const RunContext& context = {});

  [[nodiscard]] std::size_t size() const { return index_.size(); }
  /// The nearest point; index kNoIndex in an empty tree.
  [[nodiscard]] Neighbor nearest(const Vec3& query) const;
  /// The min(k, size()) nearest points into `found`, ascending; a point at the query's own place counts. Fewer when
  /// only they are within the squared distance `limit_sq`, which makes the search shorter.
  void nearest(const Vec3& query, std::size_t k, std::vector<Neighbor>& found,
               double limit_sq = std::numeric_limits<double>::infinity()) const;
  /// All points with distance <= radius, ascending.
  void within(const Vec3& query, double radius, std::vector<Neighbor>& found) const;

  /// For every point the k nearest others (not itself), nearest first: size() x k indices, kNoIndex where there are
  /// fewer. Several times faster than size() single queries: it walks the points leaf by leaf, from the bottom up.
  [[nodiscard]] std::vector<Index> all_nearest(std::size_t k, const RunContext& context = {}) const;

 private:
  struct Node {
    std::array<double, 3> min, max;  // box of the points below
    std::uint32_t begin, end;        // slots
    std::uint32_t right;             // the right child, 0 in a leaf; the left child follows its parent
    std::uint32_t parent;
  };
  class Candidates;
  std::uint32_t build(std::uint32_t begin, std::uint32_t end, std::uint32_t parent, std::span<const Vec3> points,
                      const RunContext& context);
  void search(std::uint32_t node, const std::array<double, 3>& query, Candidates& found) const;
  void scan(const Node& leaf, const std::array<double, 3>& query, Candidates& found) const;

  std::vector<Node> nodes_;
  std::vector<double> x_, y_, z_;  // coordinates in slot order
  std::vector<Index> index_;       // slot -> input index
};

}  // namespace shapelight
