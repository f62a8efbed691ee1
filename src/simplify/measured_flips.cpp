#include "simplify/measured_flips.hpp"

#include <algorithm>
#include <utility>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "simplify/star_shape.hpp"

namespace shapelight::simplification {
namespace {

constexpr double kMinGain = 1e-3;  // share of the energy of the two faces
constexpr ShapeLimits kLimits{.min_cosine = 0.2, .min_quality = 0.02};

struct Flip {
  Index f = kNoIndex;
  Index g = kNoIndex;
  double gain = 0.0;
};

struct Scratch {
  SampleBlock block;
  std::vector<Index> ids;
};

// Would a new face lie folded on the other or, where the old one did not, on the face outside across an edge?
bool flip_folds(const LiveMesh& mesh, const std::array<Index, 4>& quad, const std::array<Index, 2>& faces,
                const std::array<Vec3, 2>& before, const std::array<Vec3, 2>& after) {
  if (after[0].dot(after[1]) < kFolded) return true;
  const auto [a, b, c, d] = quad;
  struct Side {
    Index from, to;
    int old_face, new_face;
  };
  for (const Side& side : {Side{b, c, 0, 0}, Side{c, a, 0, 1}, Side{a, d, 1, 1}, Side{d, b, 1, 0}}) {
    for (const Index g : mesh.faces_at_edge(side.from, side.to)) {
      if (g == kNoIndex || g == faces[0] || g == faces[1]) continue;
      const Vec3& origin = mesh.position[side.from];
      const Vec3 normal = triangle_with(mesh, g, kNoIndex, origin, origin).normal;
      if (normal.dot(after[side.new_face]) < kFolded && normal.dot(before[side.old_face]) >= kFolded) return true;
    }
  }
  return false;
}

// Energy that the flip saves; 0 when it is not possible. Leaves the new places of the samples in `scratch`.
double gain_of(const MeasuredMesh& measured, Index f, Index g, Scratch& scratch) {
  const LiveMesh& mesh = measured.mesh;
  std::array<Index, 4> quad{};
  if (!mesh.may_flip(f, g, quad)) return 0.0;
  const auto& p = mesh.position;
  const Vec3& origin = p[quad[0]];
  const auto triangle = [&](int i, int j, int k) {
    return LocalTriangle(p[quad[i]] - origin, p[quad[j]] - origin, p[quad[k]] - origin);
  };
  const LocalTriangle old_f = triangle(0, 1, 2), old_g = triangle(1, 0, 3);
  const LocalTriangle new_f = triangle(2, 3, 1), new_g = triangle(3, 2, 0);
  const double worst = std::min(old_f.quality(), old_g.quality());
  for (const LocalTriangle* after : {&new_f, &new_g}) {
    if (!StarShape::keeps_shape(old_f.normal, *after, worst, kLimits)) return 0.0;
    if (!StarShape::keeps_shape(old_g.normal, *after, worst, kLimits)) return 0.0;
  }
  const auto agrees = [&](const LocalTriangle& t, int i, int j, int k) {
    const auto& source = mesh.source;
    return measured.agrees_with_input(t.normal, source[quad[i]], source[quad[j]], source[quad[k]]);
  };
  if (!agrees(new_f, 2, 3, 1) || !agrees(new_g, 3, 2, 0)) return 0.0;
  const Index faces[2] = {f, g};
  const double before = measured.gather(faces, origin, scratch.block, scratch.ids);
  scratch.block.reset();
  scratch.block.offer(new_f, 0);
  scratch.block.offer(new_g, 1);
  const double gain = before - scratch.block.total();
  if (!(gain > kMinGain * before)) return 0.0;
  return flip_folds(mesh, quad, {f, g}, {old_f.normal, old_g.normal}, {new_f.normal, new_g.normal}) ? 0.0 : gain;
}

// All flips that gain, best first. Every edge is seen from its face of lower index.
std::vector<Flip> find_flips(const MeasuredMesh& measured, const RunContext& context) {
  const LiveMesh& mesh = measured.mesh;
  std::vector<Flip> flips = parallel::reduce_chunks(
      context, mesh.num_faces(), std::vector<Flip>{},
      [&](std::size_t begin, std::size_t end) {
        std::vector<Flip> found;
        Scratch scratch;
        for (std::size_t i = begin; i < end; ++i) {
          const Index f = static_cast<Index>(i);
          if (!mesh.is_face_alive(f)) continue;
          const Triangle& t = mesh.face(f);
          for (int k = 0; k < 3; ++k) {
            const std::array<Index, 2> sides = mesh.faces_at_edge(t[k], t[(k + 1) % 3]);
            const Index g = sides[0] == f ? sides[1] : sides[0];
            if (g == kNoIndex || g < f || !(measured.changed[f] || measured.changed[g])) continue;
            const double gain = gain_of(measured, f, g, scratch);
            if (gain > 0.0) found.push_back({f, g, gain});
          }
        }
        return found;
      },
      [](std::vector<Flip> all, std::vector<Flip> part) {
        all.insert(all.end(), part.begin(), part.end());
        return all;
      },
      256);
  std::stable_sort(flips.begin(), flips.end(), [](const Flip& a, const Flip& b) { return a.gain > b.gain; });
  return flips;
}

}  // namespace

std::size_t flip_edges(MeasuredMesh& measured, const RunContext& context) {
  const std::vector<Flip> flips = find_flips(measured, context);
  std::fill(measured.changed.begin(), measured.changed.end(), 0);
  std::vector<std::uint8_t> taken(measured.mesh.num_faces(), 0);
  std::size_t done = 0;
  Scratch scratch;
  for (std::size_t i = 0; i < flips.size(); ++i) {
    poll(context, i);
    const Flip& flip = flips[i];
    if (taken[flip.f] || taken[flip.g]) {  // to be looked at again
      measured.changed[flip.f] = measured.changed[flip.g] = 1;
      continue;
    }
    if (gain_of(measured, flip.f, flip.g, scratch) <= 0.0) continue;  // an earlier flip has made it impossible
    taken[flip.f] = taken[flip.g] = 1;
    std::array<Index, 4> quad{};
    (void)measured.mesh.may_flip(flip.f, flip.g, quad);
    measured.mesh.flip(flip.f, flip.g, quad);
    const Index faces[2] = {flip.f, flip.g};
    measured.assign(faces, scratch.block, scratch.ids);
    ++done;
  }
  return done;
}

}  // namespace shapelight::simplification
