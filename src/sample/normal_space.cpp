#include "shapelight/sample/normal_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/random.hpp"
#include "sample/candidates.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

/// Cells of equal area on the sphere: collars from pole to pole, each cut into as many cells as its length asks for,
/// with the collars' heights chosen so that equal shares of z (Archimedes) go to equal numbers of cells.
class SphereCells {
 public:
  explicit SphereCells(int collars) : first_(1, 0) {
    for (int i = 0; i < collars; ++i) {
      const double length = 2.0 * (collars - 1) * std::sin(std::numbers::pi * i / (collars - 1));
      first_.push_back(first_.back() + std::max(1, static_cast<int>(std::lround(length))));
    }
  }
  [[nodiscard]] int find(const Vec3& normal) const {
    const int total = first_.back();
    const double below = 0.5 * (1.0 - std::clamp(normal.z(), -1.0, 1.0)) * total;  // cells' worth of area above z
    const auto next = std::upper_bound(first_.begin() + 1, first_.end() - 1, below);
    const int begin = *(next - 1);
    const int cells = *next - begin;
    // The half centres a cell on the x axis.
    const double turn = std::atan2(normal.y(), normal.x()) / (2.0 * std::numbers::pi) + 1.0;
    return begin + static_cast<int>(turn * cells + 0.5) % cells;
  }
  [[nodiscard]] int size() const { return first_.back(); }

 private:
  std::vector<int> first_;  // first cell of every collar, and the end
};

struct Draw {
  std::uint64_t turn;  // how often its cell was drawn before
  std::uint64_t key;
  Index vertex;
  friend bool operator<(const Draw& a, const Draw& b) {
    return std::tie(a.turn, a.key, a.vertex) < std::tie(b.turn, b.key, b.vertex);
  }
};

}  // namespace

std::vector<Index> sample_normal_space(const SurfaceGraph& graph, std::span<const Index> candidates,
                                       const SamplingTarget& target, const NormalSpaceSamplingOptions& options,
                                       const RunContext& context) {
  validate_options(options);
  check_sampling(graph, candidates, target);
  require_count(target, "normal");
  context.report(0.0, "normal-space sampling");

  // First sorted by (cell, random key): the place within its cell is the turn at which a vertex is drawn.
  const SphereCells cells(options.collars);
  const int no_normal = cells.size();
  std::vector<Draw> draws;
  draws.reserve(candidates.size());
  bool any_normal = false;
  for (const Index vertex : candidates) {
    const Vec3& normal = graph.normal[vertex];
    const bool has_normal = !normal.isZero(0.0);
    any_normal = any_normal || has_normal;
    draws.push_back({static_cast<std::uint64_t>(has_normal ? cells.find(normal) : no_normal),
                     random_bits(options.seed, kNormalStream, vertex), vertex});
  }
  if (!any_normal) throw InvalidInput("sampling method normal: no point has a normal, expected at least one");
  context.check();
  std::sort(draws.begin(), draws.end());

  std::uint64_t cell = draws.front().turn;
  std::uint64_t turn = 0;
  context.check();
  for (Draw& draw : draws) {
    if (draw.turn != cell) {
      cell = draw.turn;
      turn = 0;
    }
    // Vertices without a normal wait until every cell is empty.
    const std::uint64_t wait = cell == static_cast<std::uint64_t>(no_normal) ? candidates.size() : 0;
    draw.turn = wait + turn++;
    draw.key = random_bits(options.seed, kNormalTurnStream, draw.vertex);
  }
  context.check();
  const auto end = draws.begin() + static_cast<std::ptrdiff_t>(target.count);
  if (end != draws.end()) std::nth_element(draws.begin(), end, draws.end());
  std::sort(draws.begin(), end);

  std::vector<Index> chosen(target.count);
  std::transform(draws.begin(), end, chosen.begin(), [](const Draw& draw) { return draw.vertex; });
  context.report(1.0, "normal-space sampling");
  return chosen;
}

}  // namespace shapelight
