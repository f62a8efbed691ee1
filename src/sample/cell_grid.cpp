#include "sample/cell_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/poll.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

/// Number of occupied cells, or limit + 1 if there are more. Open addressing; key 0 is never used by a lattice.
std::size_t count_cells(std::span<const Vec3> points, const Lattice& lattice, std::size_t limit,
                        std::vector<std::uint64_t>& table, const RunContext& context) {
  const auto bits = static_cast<int>(std::bit_width(2 * limit + 2));
  table.assign(std::size_t{1} << bits, 0);
  const std::size_t mask = table.size() - 1;
  std::size_t count = 0;
  std::uint64_t previous = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    poll(context, i);
    const std::uint64_t key = lattice.key(points[i]);
    if (key == previous) continue;  // candidates come along a space-filling curve
    previous = key;
    std::size_t slot = (key * 0x9e3779b97f4a7c15ULL) >> (64 - bits);
    while (table[slot] != 0 && table[slot] != key) slot = (slot + 1) & mask;
    if (table[slot] == key) continue;
    if (++count > limit) return count;
    table[slot] = key;
  }
  return count;
}

}  // namespace

double Lattice::min_cell(const BoundingBox& box) {
  const double extent = (box.max - box.min).maxCoeff();
  return extent > 0.0 ? extent / (kMaxCells - 3.0) : 1.0;
}

CellGrid::CellGrid(std::span<const Vec3> points, double cell, const RunContext& context)
    : lattice_(bounding_box(points), cell), cell_(cell) {
  const std::size_t n = points.size();
  std::vector<std::pair<std::uint64_t, Index>> keyed(n);
  for (std::size_t i = 0; i < n; ++i) keyed[i] = {lattice_.key(points[i]), static_cast<Index>(i)};
  context.check();
  std::sort(keyed.begin(), keyed.end());

  point_.resize(n);
  index_.resize(n);
  cell_of_slot_.resize(n);
  std::vector<std::uint64_t> cell_keys;
  for (std::size_t slot = 0; slot < n; ++slot) {
    poll(context, slot);
    const auto [key, i] = keyed[slot];
    if (cell_keys.empty() || cell_keys.back() != key) {
      cell_keys.push_back(key);
      begin_.push_back(static_cast<std::uint32_t>(slot));
    }
    point_[slot] = points[i];
    index_[slot] = i;
    cell_of_slot_[slot] = static_cast<std::uint32_t>(cell_keys.size() - 1);
  }
  begin_.push_back(static_cast<std::uint32_t>(n));
  find_runs(cell_keys, context);
}

// Keys of one neighbour column grow with the key of the cell, so nine pairs of cursors find all of them in one sweep.
void CellGrid::find_runs(std::span<const std::uint64_t> cell_keys, const RunContext& context) {
  constexpr std::uint64_t kX = std::uint64_t{1} << (2 * Lattice::kBits);
  constexpr std::uint64_t kY = std::uint64_t{1} << Lattice::kBits;
  const std::size_t num = cell_keys.size();
  std::array<Range, 9> cursor{};
  run_begin_.reserve(num + 1);
  run_begin_.push_back(0);
  for (std::size_t cell = 0; cell < num; ++cell) {
    poll(context, cell);
    std::uint64_t column = cell_keys[cell] - kX - kY;
    for (std::size_t k = 0; k < 9; ++k) {
      auto& [low, high] = cursor[k];
      while (low < num && cell_keys[low] < column - 1) ++low;
      while (high < num && cell_keys[high] <= column + 1) ++high;
      if (low < high) runs_.emplace_back(begin_[low], begin_[high]);
      column += k % 3 == 2 ? kX - 2 * kY : kY;
    }
    run_begin_.push_back(static_cast<std::uint32_t>(runs_.size()));
  }
}

std::vector<std::uint32_t> CellGrid::slot_of_index() const {
  std::vector<std::uint32_t> slot(index_.size());
  for (std::size_t s = 0; s < index_.size(); ++s) slot[index_[s]] = static_cast<std::uint32_t>(s);
  return slot;
}

void check_cell_size(std::span<const Vec3> points, double cell, std::string_view method) {
  const double smallest = Lattice::min_cell(bounding_box(points));
  if (cell < smallest) {
    throw InvalidInput(fmt::format("sampling method {}: spacing {:g}, expected at least {:g} for points of this extent",
                                   method, cell, smallest));
  }
}

double find_cell_size(std::span<const Vec3> points, std::size_t max_cells, const RunContext& context) {
  constexpr int kSteps = 60;
  const BoundingBox box = bounding_box(points);
  const double smallest = Lattice::min_cell(box);
  double few = smallest * Lattice::kMaxCells;  // one cell
  double many = smallest;
  const std::size_t limit = std::min(points.size(), 4 * max_cells);
  std::vector<std::uint64_t> table;
  if (max_cells >= points.size() || count_cells(points, Lattice(box, many), max_cells, table, context) <= max_cells)
    return many;

  double cell = few / std::sqrt(static_cast<double>(max_cells));  // were it a square sheet
  for (int step = 0; step < kSteps && few > many * 1.0001; ++step) {
    // Cells grow like cell^-2 on a surface; where that leads out of the bracket, halve it.
    if (!(cell > many && cell < few)) cell = std::sqrt(many * few);
    const std::size_t count = count_cells(points, Lattice(box, cell), limit, table, context);
    (count <= max_cells ? few : many) = cell;
    if (count <= max_cells && static_cast<double>(count) >= 0.98 * static_cast<double>(max_cells)) break;
    cell *= std::sqrt(static_cast<double>(count) / (0.99 * static_cast<double>(max_cells)));
  }
  return few;
}

}  // namespace shapelight
