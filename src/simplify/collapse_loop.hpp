#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "shapelight/core/error.hpp"
#include "simplify/bucket_queue.hpp"
#include "simplify/collapse_rule.hpp"

namespace shapelight::simplification {

inline constexpr float kParked = -1.0f;  // key of a vertex that waits for its ring to change

/// Collapses the cheapest edges of a mesh, lazily: keys are lower bounds, made exact and checked for legality only
/// when it is their turn.
template <class Rule>
class CollapseLoop {
 public:
  using Mesh = typename Rule::Mesh;

  CollapseLoop(Mesh& mesh, std::span<const float> removal_weight, const SimplifyTarget& target,
               std::size_t fixed_copies, const RunContext& context)
      : mesh_(mesh),
        rule_(mesh, removal_weight),
        target_(target),
        fixed_copies_(fixed_copies),
        context_(context),
        num_before_(count()) {}

  /// Vertices or faces, whichever the target counts.
  [[nodiscard]] std::size_t count() const {
    return target_.vertices != 0 ? mesh_.num_live() - fixed_copies_ : mesh_.num_faces();
  }
  [[nodiscard]] bool done() const { return count() <= std::max(target_.vertices, target_.faces); }

  /// Until done or stuck. What a first pass refuses may be legal once all else has been tried; slivers come last.
  void run() {
    for (const bool slivers : {false, true}) {
      slivers_ = slivers;
      for (std::size_t before = count() + 1; !done() && count() < before;) {
        before = count();
        queue_all();
        drain();
      }
    }
  }

 private:
  void queue_all() {
    queue_.rewind();
    parallel::for_chunks(context_, mesh_.size(), [&](std::size_t begin, std::size_t end) {
      for (Index v = static_cast<Index>(begin); v < end; ++v) {
        if (!mesh_.vertex(v).is_dead()) evaluate(v);
      }
    });
    for (Index v = 0; v < mesh_.size(); ++v) {
      shapelight::poll(context_, v);
      if (!mesh_.vertex(v).is_dead()) push(v);
    }
  }

  void drain() {
    std::size_t polled = 0;
    while (true) {
      const auto& round = queue_.next_round();
      if (round.empty()) return;
      for (std::size_t i = 0; i < round.size(); ++i) {
        fetch_ahead(round, i);
        if (polled++ % 4096 == 0) poll();
        const auto [key, u] = round[i];
        if (mesh_.vertex(u).is_dead() || mesh_.vertex(u).key != key) continue;
        try_collapse(u);
        if (done()) return;
      }
    }
  }

  void poll() const {
    context_.check();
    const std::size_t target = std::max(target_.vertices, target_.faces);
    context_.report(static_cast<double>(num_before_ - count()) / static_cast<double>(num_before_ - target));
  }

  // Memory latency rules this loop. Each step needs what the one before has brought.
  void fetch_ahead(std::span<const BucketQueue::Entry> round, std::size_t i) const {
    if (i + 8 < round.size()) mesh_.prefetch_vertex(round[i + 8].id);
    if (i + 5 < round.size()) mesh_.prefetch_ring(round[i + 5].id);
    if (i + 2 < round.size()) mesh_.prefetch_neighbors(round[i + 2].id);
  }

  void evaluate(Index u) {
    float best = kNever;
    Index target = kNoIndex;
    for (const Index v : mesh_.ring(u)) {
      const float cost = rule_.cost(u, v);
      if (cost < best) {
        best = cost;
        target = v;
      }
    }
    set(u, best, target);
  }
  void set(Index u, float key, Index target) {
    mesh_.vertex(u).key = key < kNever ? key : kParked;
    mesh_.vertex(u).target = target;
  }
  void push(Index u) {
    if (mesh_.vertex(u).key != kParked) queue_.push(mesh_.vertex(u).key, u);
  }

  void try_collapse(Index u) {
    const auto& vertex = mesh_.vertex(u);
    if (mesh_.vertex(vertex.target).is_dead() || !rule_.is_exact(u)) {
      evaluate(u);
      if (vertex.key == kParked) return;
      if (!queue_.is_due(vertex.key)) return push(u);
    }
    for (const Index v : mesh_.ring(u)) mesh_.prefetch_vertex(v);
    if (rule_.prepare(u, vertex.target, slivers_) || choose_legal(u)) collapse();
  }

  // The cheapest legal target of u: true when it is due. Otherwise u is queued or parked.
  bool choose_legal(Index u) {
    candidates_.clear();
    for (const Index v : mesh_.ring(u)) {
      const float cost = rule_.cost(u, v);
      if (cost < kNever && v != mesh_.vertex(u).target) candidates_.emplace_back(cost, v);
    }
    std::sort(candidates_.begin(), candidates_.end());
    for (const auto& [cost, v] : candidates_) {
      if (!rule_.prepare(u, v, slivers_)) continue;
      set(u, cost, v);
      if (queue_.is_due(cost)) return true;
      push(u);
      return false;
    }
    set(u, kParked, kNoIndex);
    return false;
  }

  void collapse() {
    const auto [wing, kept, gained_own_edges] = rule_.collapse();
    requeue(kept);
    for (const Index w : wing.opposite) {
      if (w != kNoIndex) wake(w);
    }
    for (const Index w : wing.gained) {
      wake(w);
      if (!gained_own_edges) continue;
      const float cost = rule_.cost(w, kept);
      if (cost < mesh_.vertex(w).key) {
        set(w, cost, kept);
        push(w);
      }
    }
  }
  void requeue(Index u) {
    evaluate(u);
    push(u);
  }
  void wake(Index u) {
    if (mesh_.vertex(u).key == kParked) requeue(u);
  }

  Mesh& mesh_;
  Rule rule_;
  SimplifyTarget target_;
  std::size_t fixed_copies_;
  const RunContext& context_;
  std::size_t num_before_;
  BucketQueue queue_;
  bool slivers_ = false;
  std::vector<std::pair<float, Index>> candidates_;
};

template <class Rule>
ManifoldMesh run_collapse(ManifoldMesh&& input, const SimplifyTarget& target, const QuadricCollapse& options,
                          const RunContext& context) {
  typename Rule::Mesh mesh(input, options.boundary_weight, context);
  CollapseLoop<Rule> loop(mesh, options.removal_weight, target, input.source.size() - num_merged_vertices(input),
                          context);
  loop.run();
  if (options.must_reach && !loop.done()) {
    const bool vertices = target.vertices != 0;
    throw TargetUnreachable(
        fmt::format("simplify: target of {} {}: no edge can be collapsed without a change of topology or a face "
                    "turned over once {} are left",
                    vertices ? target.vertices : target.faces, vertices ? "vertices" : "faces", loop.count()),
        loop.count());
  }
  return mesh.finish(std::move(input), context);
}

}  // namespace shapelight::simplification
