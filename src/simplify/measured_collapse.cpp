#include "simplify/measured_collapse.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "simplify/star_shape.hpp"

namespace shapelight::simplification {
namespace {

constexpr std::size_t kChunk = 64;    // vertices per chunk: an evaluation takes microseconds
constexpr double kRoundShare = 0.25;  // of what is left to remove, per round
constexpr double kGuardFactor = 1.5;  // backward error that a removal may cost, in units of its forward error
constexpr ShapeLimits kLimits{.min_cosine = 0.2, .min_quality = 0.02};
constexpr ShapeLimits kLastResort{.min_cosine = 0.0, .min_quality = 0.0};  // when nothing else is left to remove

struct Removal {
  Index into = kNoIndex;
  float cost = std::numeric_limits<float>::infinity();
  float star_energy = 0.0F;  // after the removal
};

struct Scratch {
  SampleBlock block;
  StarShape shape;
  std::vector<Index> ids, ring, kept;
};

// What the star of u becomes when u is removed into v. Faces of u that hold v vanish; `kept` gets the others.
class RemovalTrial {
 public:
  RemovalTrial(const MeasuredMesh& measured, Index u, bool last_resort, Scratch& scratch)
      : measured_(measured), u_(u), last_resort_(last_resort), scratch_(scratch) {
    scratch.shape.measure(measured.mesh, u);
    energy_before_ = measured.gather(measured.mesh.star(u), measured.mesh.position[u], scratch.block, scratch.ids);
  }

  // Energy of the star after the removal; infinity where a face would turn over or degenerate.
  double energy_into(Index v) {
    const LiveMesh& mesh = measured_.mesh;
    const Vec3& origin = mesh.position[u_];
    scratch_.kept.clear();
    scratch_.block.reset();
    const std::span<const Index> star = mesh.star(u_);
    for (std::size_t i = 0; i < star.size(); ++i) {
      const Index f = star[i];
      const Triangle& t = mesh.face(f);
      if (t[0] == v || t[1] == v || t[2] == v) continue;
      const LocalTriangle after = triangle_with(mesh, f, u_, mesh.position[v], origin);
      const auto source = [&](int k) { return mesh.source[t[k] == u_ ? v : t[k]]; };
      if (!scratch_.shape.keeps(i, after, last_resort_ ? kLastResort : kLimits) ||
          !(last_resort_ || measured_.agrees_with_input(after.normal, source(0), source(1), source(2)))) {
        return std::numeric_limits<double>::infinity();
      }
      scratch_.block.offer(after, static_cast<std::int32_t>(scratch_.kept.size()));
      scratch_.kept.push_back(f);
    }
    return scratch_.block.total();
  }

  double line_cost(Index v) const {
    const LiveMesh& mesh = measured_.mesh;
    if (!mesh.is_on_line(u_)) return 0.0;
    const auto& [first, second] = mesh.line_edges(u_);
    const Index far = mesh.other_end(mesh.other_end(first, u_) == v ? second : first, u_);
    double cost = 0.0;
    for (const Index e : {first, second}) {
      measured_.for_line_samples(e, [&](const LineSample& s) {
        cost += s.weight * segment_distance_sq(s.position, mesh.position[v], mesh.position[far]) - s.error;
      });
    }
    return cost;
  }

  double energy_before() const { return energy_before_; }

 private:
  const MeasuredMesh& measured_;
  Index u_;
  bool last_resort_;
  Scratch& scratch_;
  double energy_before_ = 0.0;
};

Removal best_removal(const MeasuredMesh& measured, Index u, bool last_resort, Scratch& scratch) {
  const LiveMesh& mesh = measured.mesh;
  Removal best;
  if (!mesh.is_alive(u) || mesh.locked[u]) return best;
  mesh.neighbors(u, scratch.ring);
  std::sort(scratch.ring.begin(), scratch.ring.end());  // ties go to the smallest index
  RemovalTrial trial(measured, u, last_resort, scratch);
  for (const Index v : scratch.ring) {
    if (!mesh.may_collapse(u, v)) continue;
    const double after = trial.energy_into(v);
    const float cost = static_cast<float>(after - trial.energy_before() + trial.line_cost(v));
    if (cost < best.cost && (last_resort || !folds_faces(mesh, u, v))) best = {v, cost, static_cast<float>(after)};
  }
  return best;
}

// A removal that has been chosen: the new places of the samples of its star.
struct Prepared {
  Index u = kNoIndex;
  SampleBlock block;
  std::vector<Index> ids, kept, ring;
};

class Collapser {
 public:
  Collapser(MeasuredMesh& measured, const MeasuredCollapse& options, const RunContext& context)
      : measured_(measured),
        options_(options),
        context_(context),
        removal_(measured.mesh.num_vertices()),
        guarded_(measured.mesh.num_vertices(), 0),
        blocked_(measured.mesh.num_vertices(), 0) {
    evaluate_all();
  }

  bool run(std::size_t num_to_remove) {
    const std::size_t all = num_to_remove;
    while (num_to_remove > 0) {
      context_.report(1.0 - static_cast<double>(num_to_remove) / static_cast<double>(all));
      evaluate();
      const std::vector<Index> chosen = choose(num_to_remove);
      if (chosen.empty()) {
        if (std::exchange(last_resort_, true)) return false;
        evaluate_all();
        continue;
      }
      num_to_remove -= commit(chosen);
    }
    return true;
  }

 private:
  void evaluate_all() {
    dirty_.resize(removal_.size());
    std::iota(dirty_.begin(), dirty_.end(), Index{0});
  }

  void evaluate() {
    parallel::for_chunks(
        context_, dirty_.size(),
        [&](std::size_t begin, std::size_t end) {
          Scratch scratch;
          for (std::size_t i = begin; i < end; ++i) {
            const Index u = dirty_[i];
            removal_[u] = best_removal(measured_, u, last_resort_, scratch);
            guarded_[u] = 0;
            const std::span<const float> weight = options_.removal_weight;
            if (!weight.empty() && removal_[u].cost > 0.0F) removal_[u].cost *= weight[measured_.mesh.source[u]];
          }
        },
        kChunk);
    dirty_.clear();
  }

  bool before(Index a, Index b) const { return std::pair(removal_[a].cost, a) < std::pair(removal_[b].cost, b); }

  // The cheapest removals, cheapest first.
  std::vector<Index> cheapest(std::size_t count) {
    std::vector<Index> order;
    for (Index v = 0; v < removal_.size(); ++v) {
      if (removal_[v].into != kNoIndex) order.push_back(v);
    }
    count = std::min(count, order.size());
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(count);
    const auto less = [&](Index a, Index b) { return before(a, b); };
    context_.check();
    std::nth_element(order.begin(), count < order.size() ? middle : order.begin(), order.end(), less);
    context_.check();
    order.resize(count);
    std::sort(order.begin(), order.end(), less);
    return order;
  }

  // Removals whose faces would stand far off the input are put back once, with that as their cost.
  bool guard(std::span<const Index> order) {
    if (!options_.backward) return false;
    std::vector<std::uint8_t> put_back(order.size(), 0);
    parallel::for_chunks(
        context_, order.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const Index u = order[i];
            if (std::exchange(guarded_[u], 1)) continue;
            const double error = options_.backward(u, removal_[u].into);
            if (error <= kGuardFactor * removal_[u].star_energy) continue;
            removal_[u].cost = std::max(removal_[u].cost, static_cast<float>(error));
            put_back[i] = 1;
          }
        },
        kChunk);
    return std::find(put_back.begin(), put_back.end(), 1) != put_back.end();
  }

  // An independent set of the cheapest removals: no two of them share a face.
  std::vector<Index> choose(std::size_t num_to_remove) {
    const std::size_t some = measured_.mesh.num_live_vertices() / 64 + 1;
    const auto share = static_cast<std::size_t>(kRoundShare * static_cast<double>(num_to_remove));
    const std::size_t count = std::min(num_to_remove, std::max(share, some));
    std::vector<Index> order = cheapest(count);
    while (guard(order)) order = cheapest(count);
    std::vector<Index> chosen, ring;
    for (std::size_t i = 0; i < order.size(); ++i) {
      poll(context_, i);
      const Index u = order[i];
      if (blocked_[u]) continue;
      measured_.mesh.neighbors(u, ring);
      for (const Index w : ring) blocked_[w] = 1;
      marked_.insert(marked_.end(), ring.begin(), ring.end());
      chosen.push_back(u);
    }
    for (const Index w : marked_) blocked_[w] = 0;
    marked_.clear();
    return chosen;
  }

  std::vector<Prepared> prepare(std::span<const Index> chosen) {
    std::vector<Prepared> prepared(chosen.size());
    parallel::for_chunks(
        context_, chosen.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            Scratch scratch;
            RemovalTrial trial(measured_, chosen[i], last_resort_, scratch);
            (void)trial.energy_into(removal_[chosen[i]].into);
            measured_.mesh.neighbors(chosen[i], scratch.ring);
            prepared[i] = {chosen[i], std::move(scratch.block), std::move(scratch.ids), std::move(scratch.kept),
                           std::move(scratch.ring)};
          }
        },
        kChunk);
    return prepared;
  }

  // Returns how many were removed. What an earlier removal of the round has made impossible waits for the next.
  std::size_t commit(std::span<const Index> chosen) {
    std::vector<Index> touched, targets;
    std::size_t removed = 0;
    const std::vector<Prepared> prepared = prepare(chosen);
    for (std::size_t i = 0; i < prepared.size(); ++i) {
      poll(context_, i);
      const Prepared& p = prepared[i];
      const Index v = removal_[p.u].into;
      touched.insert(touched.end(), p.ring.begin(), p.ring.end());
      removal_[p.u] = {};
      if (!measured_.mesh.may_collapse(p.u, v) || (!last_resort_ && folds_faces(measured_.mesh, p.u, v))) {
        touched.push_back(p.u);
        continue;
      }
      collapse(p, v);
      targets.push_back(v);
      ++removed;
    }
    if (options_.fit) {
      sort_unique(targets);
      options_.fit(targets);
      std::vector<Index> ring;
      for (const Index v : targets) {
        measured_.mesh.neighbors(v, ring);
        touched.insert(touched.end(), ring.begin(), ring.end());
      }
    }
    context_.check();
    sort_unique(touched);
    dirty_ = std::move(touched);
    return removed;
  }

  void collapse(const Prepared& p, Index v) {
    LiveMesh& mesh = measured_.mesh;
    const std::array<Index, 2> lines = mesh.line_edges(p.u);
    mesh.collapse(p.u, v);
    measured_.assign(p.kept, p.block, p.ids);
    if (lines[0] == kNoIndex) return;
    const auto& [a, b] = mesh.line_ends(lines[0]);
    const bool first_lives = a != p.u && b != p.u;
    measured_.merge_line(lines[first_lives ? 1 : 0], lines[first_lives ? 0 : 1]);
  }

  static void sort_unique(std::vector<Index>& v) {
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
  }

  MeasuredMesh& measured_;
  const MeasuredCollapse& options_;
  const RunContext& context_;
  std::vector<Removal> removal_;  // per vertex: the best way to remove it
  std::vector<std::uint8_t> guarded_, blocked_;
  std::vector<Index> dirty_, marked_;
  bool last_resort_ = false;  // once nothing else is left
};

}  // namespace

bool collapse_measured(MeasuredMesh& measured, std::size_t num_to_remove, const MeasuredCollapse& options,
                       const RunContext& context) {
  return Collapser(measured, options, context).run(num_to_remove);
}

}  // namespace shapelight::simplification
