#include "simplify/vertex_moves.hpp"

#include <algorithm>
#include <numeric>

#include "core/parallel.hpp"
#include "simplify/star_shape.hpp"
#include "simplify/vertex_fit.hpp"

namespace shapelight::simplification {
namespace {

constexpr std::size_t kMaxTrials = 6;  // places tried per vertex, the most promising first
constexpr double kMinGain = 1e-3;      // share of the star's energy
constexpr std::size_t kChunk = 64;

struct Candidate {
  Index vertex = kNoIndex;
  double change = 0.0;  // of the energy, as the model has it
};

// Free input vertices that v could move to, best first.
std::vector<Candidate> candidates(const MeasuredMesh& measured, const InputPlaces& places, Index v,
                                  double normal_weight) {
  const LiveMesh& mesh = measured.mesh;
  const FitModel model = fit_model(measured, v, normal_weight);
  std::vector<Candidate> found;
  const auto consider = [&](Index w) {
    if (w == kNoIndex || places.taken[w] || places.locked[w]) return;
    found.push_back({w, model.change(places.position[w] - mesh.position[v])});
  };
  if (mesh.is_on_line(v)) {
    for (const Index w : places.line[mesh.source[v]]) consider(w);
  } else {
    for (const Index f : mesh.star(v)) {
      measured.for_samples(f, [&](const SurfaceSample& s) {
        if (s.vertex != kNoIndex && places.line[s.vertex][0] == kNoIndex) consider(s.vertex);
      });
    }
  }
  const auto better = [](const Candidate& a, const Candidate& b) {
    return a.change < b.change || (a.change == b.change && a.vertex < b.vertex);
  };
  const std::size_t count = std::min(kMaxTrials, found.size());
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), found.end(), better);
  found.resize(count);
  return found;
}

// The input vertex that v leaves; kNoIndex when it stays.
Index move(MeasuredMesh& measured, InputPlaces& places, Index v, double normal_weight, StarTrial& trial) {
  LiveMesh& mesh = measured.mesh;
  const std::vector<Candidate> tries = candidates(measured, places, v, normal_weight);
  if (tries.empty()) return kNoIndex;
  trial.begin(measured, v);
  double least = trial.energy_now() * (1.0 - kMinGain);
  Index best = kNoIndex;
  for (const Candidate& c : tries) {
    const double energy = trial.energy_at(places.position[c.vertex], c.vertex);
    if (energy < least) {
      least = energy;
      best = c.vertex;
    }
  }
  if (best == kNoIndex) return kNoIndex;
  if (best != tries.back().vertex) (void)trial.energy_at(places.position[best], best);
  trial.accept(measured);
  places.taken[best] = 1;
  return std::exchange(mesh.source[v], best);
}

}  // namespace

std::size_t move_vertices(MeasuredMesh& measured, InputPlaces& places, double normal_weight,
                          const RunContext& context) {
  const LiveMesh& mesh = measured.mesh;
  std::vector<Index> movable;
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    if (mesh.is_alive(v) && !mesh.locked[v]) movable.push_back(v);
  }
  std::size_t moves = 0;
  for (const std::vector<Index>& independent : independent_classes(mesh, movable, context)) {
    std::vector<Index> left(independent.size(), kNoIndex);
    std::vector<Vec3> before(independent.size());
    parallel::for_chunks(
        context, independent.size(),
        [&](std::size_t begin, std::size_t end) {
          StarTrial trial;
          for (std::size_t i = begin; i < end; ++i) {
            before[i] = mesh.position[independent[i]];
            left[i] = move(measured, places, independent[i], normal_weight, trial);
          }
        },
        kChunk);
    for (const std::size_t i : put_folded_back(measured, independent, before, context)) {
      Index& source = measured.mesh.source[independent[i]];
      places.taken[source] = 0;
      source = std::exchange(left[i], kNoIndex);
    }
    for (const Index w : left) {  // a place that was left is free for the next class on
      if (w == kNoIndex) continue;
      places.taken[w] = 0;
      ++moves;
    }
  }
  return moves;
}

}  // namespace shapelight::simplification
