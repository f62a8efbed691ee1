#include "shapelight/sample/paper_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "core/poll.hpp"
#include "sample/candidates.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

constexpr int kHistogramBins = 32;
constexpr double kRelax = 0.7;
constexpr int kMaxRelaxations =
    60;  // 0.7^60 is below any spacing of doubles that are not equal; then the limit is dropped

// Shares `total` among parts in proportion to `weight`, none above its `capacity`: largest remainder, repeated while
// capped parts leave something over. Pre: the capacities add up to at least `total`.
std::vector<std::size_t> share_out(std::size_t total, std::span<const double> weight,
                                   std::span<const std::size_t> capacity) {
  std::vector<std::size_t> quota(weight.size(), 0);
  std::size_t left = total;
  while (left > 0) {
    double sum = 0.0;
    for (std::size_t i = 0; i < quota.size(); ++i) sum += quota[i] < capacity[i] ? weight[i] : 0.0;
    std::vector<std::pair<double, std::size_t>> remainders;
    const std::size_t round_total = left;
    for (std::size_t i = 0; i < quota.size(); ++i) {
      if (quota[i] >= capacity[i]) continue;
      const double exact = sum > 0.0 ? static_cast<double>(round_total) * weight[i] / sum : 0.0;
      const auto whole = std::min(static_cast<std::size_t>(exact), std::min(capacity[i] - quota[i], left));
      quota[i] += whole;
      left -= whole;
      remainders.emplace_back(-(exact - std::floor(exact)), i);
    }
    std::sort(remainders.begin(), remainders.end());
    for (const auto& [remainder, i] : remainders) {
      if (left == 0) break;
      if (quota[i] < capacity[i]) {
        ++quota[i];
        --left;
      }
    }
  }
  return quota;
}

std::vector<Index> choose_local(std::span<const Index> candidates, std::span<const double> shape_index,
                                std::span<const std::uint32_t> segment, std::size_t count, const RunContext& context) {
  std::map<std::uint32_t, std::vector<Index>> members;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    poll(context, i);
    members[segment[candidates[i]]].push_back(candidates[i]);
  }
  std::vector<double> weight;
  std::vector<std::size_t> capacity;
  for (const auto& [label, vertices] : members) {
    weight.push_back(static_cast<double>(vertices.size()));
    capacity.push_back(vertices.size());
  }
  const std::vector<std::size_t> quota = share_out(count, weight, capacity);
  std::vector<Index> chosen;
  chosen.reserve(count);
  auto next_quota = quota.begin();
  for (auto& [label, vertices] : members) {
    context.check();
    const auto end = vertices.begin() + static_cast<std::ptrdiff_t>(*next_quota++);
    std::partial_sort(vertices.begin(), end, vertices.end(), [&](Index a, Index b) {
      const double sa = std::abs(shape_index[a]);
      const double sb = std::abs(shape_index[b]);
      return sa > sb || (sa == sb && a < b);
    });
    chosen.insert(chosen.end(), vertices.begin(), end);
  }
  return chosen;
}

using Cell = std::array<std::int64_t, 3>;

struct Voxel {
  std::vector<Index> open;    // vertices that may still be chosen
  std::vector<Index> chosen;  // global picks in here
  Vec3 centroid = Vec3::Zero();
  std::size_t quota = 0;
};

double entropy(std::span<const Index> vertices, std::span<const double> shape_index) {
  std::array<std::size_t, kHistogramBins> bins{};
  for (const Index v : vertices) {
    const double t = (shape_index[v] + 1.0) * 0.5 * kHistogramBins;
    ++bins[static_cast<std::size_t>(std::clamp(t, 0.0, kHistogramBins - 1.0))];
  }
  double sum = 0.0;
  for (const std::size_t count : bins) {
    if (count == 0) continue;
    const double p = static_cast<double>(count) / static_cast<double>(vertices.size());
    sum -= p * std::log2(p);  // eq. 13
  }
  return sum;
}

class GlobalSampler {
 public:
  GlobalSampler(const SurfaceGraph& graph, std::span<const Index> open, std::span<const double> shape_index,
                std::size_t count, double cell_size, const RunContext& context)
      : graph_(graph), cell_size_(cell_size) {
    for (std::size_t i = 0; i < open.size(); ++i) {
      poll(context, i);
      voxels_[cell_of(open[i])].open.push_back(open[i]);
    }
    std::vector<double> weight;
    std::vector<std::size_t> capacity;
    for (auto& [cell, voxel] : voxels_) {
      poll(context, weight.size());
      for (const Index v : voxel.open) voxel.centroid += graph.position[v];
      voxel.centroid /= static_cast<double>(voxel.open.size());
      weight.push_back(1.0 + entropy(voxel.open, shape_index));
      capacity.push_back(voxel.open.size());
    }
    const std::vector<std::size_t> quota = share_out(count, weight, capacity);
    auto next = quota.begin();
    for (auto& [cell, voxel] : voxels_) voxel.quota = *next++;
  }

  std::vector<Index> run(double min_distance, const RunContext& context) {
    for (int round = 0; fill(round < kMaxRelaxations ? min_distance : 0.0, context); ++round) min_distance *= kRelax;
    return picks_;
  }

 private:
  Cell cell_of(Index v) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) {
      // Cells too small to count share the last one, so that any size the user names gives a sample.
      cell[axis] = std::llround(std::clamp(std::floor(graph_.position[v][axis] / cell_size_), -0x1p62, 0x1p62));
    }
    return cell;
  }

  // One pass over the voxels; true while a quota is not filled.
  bool fill(double min_distance, const RunContext& context) {
    bool unfilled = false;
    for (auto& [cell, voxel] : voxels_) {
      while (voxel.chosen.size() < voxel.quota) {
        const auto best = find_best(cell, voxel, min_distance, context);
        if (best == voxel.open.end()) break;
        picks_.push_back(*best);
        voxel.chosen.push_back(*best);
        voxel.open.erase(best);
      }
      unfilled = unfilled || voxel.chosen.size() < voxel.quota;
    }
    return unfilled;
  }

  // Nearest to the centroid while the voxel has none, then farthest from its own.
  std::vector<Index>::iterator find_best(const Cell& cell, Voxel& voxel, double min_distance,
                                         const RunContext& context) {
    auto best = voxel.open.end();
    double best_score = -std::numeric_limits<double>::infinity();
    for (auto v = voxel.open.begin(); v != voxel.open.end(); ++v) {
      poll(context, num_tried_++);
      double score = 0.0;
      if (voxel.chosen.empty()) {
        score = -(graph_.position[*v] - voxel.centroid).squaredNorm();
      } else {
        score = std::numeric_limits<double>::infinity();
        for (const Index c : voxel.chosen)
          score = std::min(score, (graph_.position[*v] - graph_.position[c]).squaredNorm());
      }
      if (score > best_score && is_free(cell, *v, min_distance)) {
        best_score = score;
        best = v;
      }
    }
    return best;
  }

  // The distance is there for samples on either side of a voxel's wall: adjacent voxels are asked.
  bool is_free(const Cell& cell, Index v, double min_distance) const {
    for (std::int64_t x = cell[0] - 1; x <= cell[0] + 1; ++x) {
      for (std::int64_t y = cell[1] - 1; y <= cell[1] + 1; ++y) {
        for (std::int64_t z = cell[2] - 1; z <= cell[2] + 1; ++z) {
          const auto found = voxels_.find({x, y, z});
          if (found == voxels_.end()) continue;
          for (const Index c : found->second.chosen) {
            if ((graph_.position[c] - graph_.position[v]).squaredNorm() < min_distance * min_distance) return false;
          }
        }
      }
    }
    return true;
  }

  const SurfaceGraph& graph_;
  double cell_size_;
  std::map<Cell, Voxel> voxels_;
  std::vector<Index> picks_;
  std::size_t num_tried_ = 0;
};

// Area that the candidates stand for; a cloud without area (all points on one line) gets its box's.
double area_of(const SurfaceGraph& graph, std::span<const Index> candidates) {
  double area = 0.0;
  for (const Index v : candidates) area += graph.area[v];
  if (area > 0.0) return area;
  const double diagonal = bounding_box(graph.position).diagonal();
  return diagonal > 0.0 ? diagonal * diagonal : 1.0;
}

}  // namespace

std::vector<Index> sample_paper(const SurfaceGraph& graph, std::span<const Index> candidates,
                                std::span<const double> shape_index, std::span<const std::uint32_t> segment,
                                const SamplingTarget& target, const PaperSamplingOptions& options,
                                const RunContext& context) {
  validate_options(options);
  check_sampling(graph, candidates, target);
  if (target.count == 0) throw InvalidInput("the paper's sampling takes a count or a ratio, not a spacing");
  if (shape_index.size() != graph.size() || segment.size() != graph.size()) {
    throw InvalidInput(fmt::format("paper sampling: {} shape indices and {} segments for {} vertices",
                                   shape_index.size(), segment.size(), graph.size()));
  }
  const auto num_local =
      static_cast<std::size_t>(std::llround(options.local_weight * static_cast<double>(target.count)));
  std::vector<Index> picks = choose_local(candidates, shape_index, segment, num_local, context);
  const std::size_t num_global = target.count - num_local;
  if (num_global == 0) return picks;

  std::vector<std::uint8_t> taken(graph.size(), 0);
  for (const Index v : picks) taken[v] = 1;
  std::vector<Index> open;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(open), [&](Index v) { return taken[v] == 0; });
  const double share = area_of(graph, candidates) / static_cast<double>(num_global);
  const double cell_size = options.voxel_size > 0.0 ? options.voxel_size : std::sqrt(1.5 * share);
  const std::vector<Index> global =
      GlobalSampler(graph, open, shape_index, num_global, cell_size, context).run(0.5 * std::sqrt(share), context);
  picks.insert(picks.end(), global.begin(), global.end());
  return picks;
}

}  // namespace shapelight
