#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/data/geometry.hpp"

namespace shapelight {

/// Cubic cells over a bounding box, numbered so that a cell and its neighbours along z have consecutive keys.
/// The centre of the box is the centre of a cell, so that a flat sheet does not lie on the border of its cells.
class Lattice {
 public:
  static constexpr int kBits = 21;                               ///< per axis
  static constexpr double kMaxCells = double{(1 << kBits) - 2};  ///< per axis; one cell stays free on either side

  Lattice(const BoundingBox& box, double cell) : center_(box.center()), per_length_(1.0 / cell) {
    const Vec3 half = 0.5 * per_length_ * (box.max - box.min);
    shift_ = (half.array() + 0.5).floor() + 1.5;
  }

  [[nodiscard]] std::uint64_t key(const Vec3& p) const {
    const Vec3 q = (p - center_) * per_length_ + shift_;
    auto axis = [&](int a) { return static_cast<std::uint64_t>(q[a]); };
    return (((axis(0) << kBits) | axis(1)) << kBits) | axis(2);
  }
  /// Position within its cell, each coordinate in [0, 1).
  [[nodiscard]] Vec3 within(const Vec3& p) const {
    const Vec3 q = (p - center_) * per_length_ + shift_;
    return q - q.array().floor().matrix();
  }
  /// Smallest cell that a key can hold. Positive, also for a box without extent.
  [[nodiscard]] static double min_cell(const BoundingBox& box);

 private:
  Vec3 center_;
  double per_length_;
  Vec3 shift_;  // [cells] makes the smallest coordinate at least 1, so that neighbours never wrap around
};

/// Points sorted by lattice cell, in flat arrays. A slot is a place in that order.
class CellGrid {
 public:
  using Range = std::pair<std::uint32_t, std::uint32_t>;  // slots [first, second)

  /// Pre: cell >= Lattice::min_cell(bounding_box(points)).
  CellGrid(std::span<const Vec3> points, double cell, const RunContext& context);

  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }
  [[nodiscard]] std::size_t size() const { return index_.size(); }
  [[nodiscard]] std::size_t num_cells() const { return begin_.size() - 1; }
  [[nodiscard]] Range slots_of_cell(std::size_t cell) const { return {begin_[cell], begin_[cell + 1]}; }
  [[nodiscard]] Index index(std::size_t slot) const { return index_[slot]; }  ///< of the point, as given
  [[nodiscard]] const Vec3& point(std::size_t slot) const { return point_[slot]; }
  [[nodiscard]] std::vector<std::uint32_t> slot_of_index() const;

  /// visit(slot) for every point in the 27 cells around that of `slot`: all points within one cell size, and more.
  template <class Visit>
  void for_each_near(std::size_t slot, Visit&& visit) const {
    const std::uint32_t cell = cell_of_slot_[slot];
    for (std::uint32_t r = run_begin_[cell]; r < run_begin_[cell + 1]; ++r) {
      for (std::uint32_t other = runs_[r].first; other < runs_[r].second; ++other) visit(other);
    }
  }

 private:
  void find_runs(std::span<const std::uint64_t> cell_keys, const RunContext& context);

  Lattice lattice_;
  double cell_;
  std::vector<Vec3> point_;   // by slot
  std::vector<Index> index_;  // by slot
  std::vector<std::uint32_t> cell_of_slot_;
  std::vector<std::uint32_t> begin_;      // first slot of every cell, and the end
  std::vector<std::uint32_t> run_begin_;  // by cell, into runs_
  std::vector<Range> runs_;               // non-empty columns of three cells around a cell, at most nine
};

/// Throws InvalidInput that names the method when the cells are too small to be numbered.
void check_cell_size(std::span<const Vec3> points, double cell, std::string_view method);

/// Cell size with at most `max_cells` occupied cells, and at least 98 % of that where the points allow it.
/// Pre: points not empty, max_cells >= 1.
[[nodiscard]] double find_cell_size(std::span<const Vec3> points, std::size_t max_cells, const RunContext& context);

}  // namespace shapelight
