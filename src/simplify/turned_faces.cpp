#include "simplify/turned_faces.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/poll.hpp"
#include "shapelight/spatial/kd_tree.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight {
namespace {

constexpr double kFolded = -0.9;   // cosine between the normals of faces that lie on each other
constexpr double kAgainst = -0.5;  // cosine from which a face looks against the input
constexpr double kNoArea = 1e-9;   // twice the area over the longest edge squared: no normal to speak of
constexpr double kOver = 0.25;     // of its height over the opposite edge that a corner goes beyond that edge
constexpr int kMaxPasses = 8;

Vec3 normal_of(const std::vector<Vec3>& positions, const Triangle& t) {
  const Vec3 u = positions[t[1]] - positions[t[0]], v = positions[t[2]] - positions[t[0]];
  const Vec3 cross = u.cross(v);
  const double length = cross.norm();
  const double longest_sq = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
  return length > kNoArea * longest_sq ? Vec3(cross / length) : Vec3::Zero();
}

// Whether the face looks against the input at all of its places that are tried.
bool looks_against(const TriangleMesh& mesh, std::size_t face, const TriangleMesh& reference,
                   const TriangleTree& tree) {
  const auto& [a, b, c] = mesh.triangles[face];
  const Vec3 normal = normal_of(mesh.positions, mesh.triangles[face]);
  const Vec3 center = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3.0;
  for (const Vec3& place : {center, Vec3(0.5 * (center + mesh.positions[a])), Vec3(0.5 * (center + mesh.positions[b])),
                            Vec3(0.5 * (center + mesh.positions[c]))}) {
    const Triangle& below = reference.triangles[tree.closest(place).triangle];
    if (normal_of(reference.positions, below).dot(normal) > kAgainst) return false;
  }
  return true;
}

// An edge flip: faces (a, b, c) and (b, a, d) become (c, d, b) and (d, c, a).
struct Flip {
  Index f, g;
  Triangle new_f, new_g;
};

std::optional<Flip> flip_at(const TriangleMesh& mesh, const EdgeUses& edges, Index f, std::size_t corner) {
  const Triangle& t = mesh.triangles[f];
  const Index a = t[corner], b = t[(corner + 1) % 3], c = t[(corner + 2) % 3];
  const std::span<const EdgeUse> sides = edges.faces_at(a, b);
  if (sides.size() != 2) return {};
  const Index g = sides[0].face == f ? sides[1].face : sides[0].face;
  Index d = kNoIndex;
  for (std::size_t k = 0; k < 3; ++k) {
    if (mesh.triangles[g][k] == b && mesh.triangles[g][(k + 1) % 3] == a) d = mesh.triangles[g][(k + 2) % 3];
  }
  if (d == kNoIndex || d == c || !edges.faces_at(c, d).empty()) return {};
  return Flip{f, g, {c, d, b}, {d, c, a}};
}

// The least cosine between a new face and the other one or a face outside across an edge; -1 when a face would lie
// folded on all its neighbours, a new one or one outside.
double worst_fold(const TriangleMesh& mesh, const EdgeUses& edges, const Flip& flip) {
  const std::array<Triangle, 2> faces = {flip.new_f, flip.new_g};
  const std::array<Vec3, 2> normal = {normal_of(mesh.positions, faces[0]), normal_of(mesh.positions, faces[1])};
  const auto best_outside = [&](const Vec3& n, const Triangle& t, Index self) {
    double best = -1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      for (const EdgeUse& use : edges.faces_at(t[k], t[(k + 1) % 3])) {
        if (use.face == flip.f || use.face == flip.g || use.face == self) continue;
        best = std::max(best, n.dot(normal_of(mesh.positions, mesh.triangles[use.face])));
      }
    }
    return best;
  };
  const double between = normal[0].dot(normal[1]);
  double worst = between;
  for (std::size_t i = 0; i < 2; ++i) {
    if (normal[i].isZero() || std::max(between, best_outside(normal[i], faces[i], kNoIndex)) <= kFolded) return -1.0;
    for (std::size_t k = 1; k < 3; ++k) {  // edge 0 is the new one
      for (const EdgeUse& use : edges.faces_at(faces[i][k], faces[i][(k + 1) % 3])) {
        if (use.face == flip.f || use.face == flip.g) continue;
        const Triangle& outside = mesh.triangles[use.face];
        const Vec3 n = normal_of(mesh.positions, outside);
        const double cosine = n.dot(normal[i]);
        if (std::max(cosine, best_outside(n, outside, use.face)) <= kFolded) return -1.0;
        worst = std::min(worst, cosine);
      }
    }
  }
  return worst;
}

template <class IsFixed>
std::optional<Flip> best_flip(const TriangleMesh& mesh, const EdgeUses& edges, Index face, IsFixed&& is_fixed) {
  std::optional<Flip> best;
  double best_fold = -1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (is_fixed(mesh.triangles[face][k]) && is_fixed(mesh.triangles[face][(k + 1) % 3])) continue;
    const std::optional<Flip> flip = flip_at(mesh, edges, face, k);
    if (!flip) continue;
    const double fold = worst_fold(mesh, edges, *flip);
    if (fold <= best_fold) continue;
    best_fold = fold;
    best = flip;
  }
  return best;
}

// Where no flip helps, a corner of the face moves.
class Relocation {
 public:
  Relocation(const TriangleMesh& reference, SimplifiedMesh& result, Placement placement, const RunContext& context)
      : reference_(reference), result_(result), placement_(placement), context_(context) {}

  // Makes the move that leaves the faces around best, if any leaves none of them folded on all its neighbours.
  template <class IsFixed>
  void relocate(const EdgeUses& edges, const Triangle& face, IsFixed&& is_fixed) {
    std::optional<Move> best;
    double best_fold = kFolded;
    for (std::size_t k = 0; k < 3; ++k) {
      if (is_fixed(face[k])) continue;
      const std::vector<Index> star = star_of(face[k]), around = with_neighbors(edges, star);
      for (const Move& move : moves(edges, face, k, star)) {
        const double fold = fold_after(edges, around, move);
        if (fold <= best_fold) continue;
        best_fold = fold;
        best = move;
      }
    }
    if (!best) return;
    result_.mesh.positions[best->vertex] = best->place;
    if (placement_ == Placement::Input) {
      used_[result_.source_vertex[best->vertex]] = 0;
      used_[best->source] = 1;
      result_.source_vertex[best->vertex] = best->source;
    }
  }

 private:
  struct Move {
    Index vertex;
    Index source;
    Vec3 place;
  };

  [[nodiscard]] std::vector<Index> star_of(Index v) const {
    std::vector<Index> faces;
    for (Index f = 0; f < result_.mesh.triangles.size(); ++f) {
      const Triangle& t = result_.mesh.triangles[f];
      if (t[0] == v || t[1] == v || t[2] == v) faces.push_back(f);
    }
    return faces;
  }

  [[nodiscard]] std::vector<Index> with_neighbors(const EdgeUses& edges, std::vector<Index> faces) const {
    for (std::size_t i = 0, count = faces.size(); i < count; ++i) {
      const Triangle& t = result_.mesh.triangles[faces[i]];
      for (std::size_t k = 0; k < 3; ++k) {
        for (const EdgeUse& use : edges.faces_at(t[k], t[(k + 1) % 3])) faces.push_back(use.face);
      }
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
  }

  // Towards the middle of the neighbours, on a border of those along it, and back over the opposite edge of the face.
  // A vertex at edges of more than two faces stays.
  std::vector<Move> moves(const EdgeUses& edges, const Triangle& face, std::size_t corner,
                          std::span<const Index> star) {
    const std::vector<Vec3>& p = result_.mesh.positions;
    const Index v = face[corner];
    Vec3 sum[2] = {Vec3::Zero(), Vec3::Zero()};  // of the neighbours along borders, of all
    double count[2] = {0.0, 0.0};
    for (const Index f : star) {
      for (const Index w : result_.mesh.triangles[f]) {
        const std::size_t sides = w == v ? 0 : edges.faces_at(v, w).size();
        if (sides > 2) return {};
        if (sides == 1) sum[0] += p[w], count[0] += 1.0;
        if (sides > 0) sum[1] += p[w] / static_cast<double>(sides), count[1] += 1.0 / static_cast<double>(sides);
      }
    }
    const std::size_t kind = count[0] > 0.0 ? 0 : 1;
    const Vec3 &a = p[face[(corner + 1) % 3]], &b = p[face[(corner + 2) % 3]];
    const Vec3 along = (b - a).normalized();
    const Vec3 height = (p[v] - a) - along.dot(p[v] - a) * along;
    const Vec3 places[2] = {sum[kind] / count[kind], 0.5 * (a + b) - kOver * height};
    std::vector<Move> found;
    for (const Vec3& place : places) {
      if (placement_ == Placement::Optimal) {
        found.push_back({v, kNoIndex, place});
        continue;
      }
      prepare_places();
      places_->nearest(place, 64, near_);
      for (const Neighbor& n : near_) {
        const Index source = place_of_[n.index];
        if (used_[source] == 0) found.push_back({v, source, reference_.positions[source]});
      }
    }
    return found;
  }

  // Input vertices in faces, and which of them the result has.
  void prepare_places() {
    if (places_) return;
    std::vector<std::uint8_t> in_face(reference_.positions.size(), 0);
    for (const Triangle& t : reference_.triangles) in_face[t[0]] = in_face[t[1]] = in_face[t[2]] = 1;
    std::vector<Vec3> positions;
    for (Index v = 0; v < in_face.size(); ++v) {
      if (in_face[v] == 0) continue;
      place_of_.push_back(v);
      positions.push_back(reference_.positions[v]);
    }
    places_.emplace(positions, context_);
    used_.assign(in_face.size(), 0);
    for (const Index source : result_.source_vertex) used_[source] = 1;
  }

  // The least, over these faces, of the largest cosine with a neighbour.
  [[nodiscard]] double fold_after(const EdgeUses& edges, std::span<const Index> faces, const Move& move) {
    std::vector<Vec3>& positions = result_.mesh.positions;
    const Vec3 before = std::exchange(positions[move.vertex], move.place);
    double worst = 1.0;
    for (const Index f : faces) {
      const Triangle& t = result_.mesh.triangles[f];
      const Vec3 normal = normal_of(positions, t);
      double best = -1.0;
      for (std::size_t k = 0; k < 3; ++k) {
        for (const EdgeUse& use : edges.faces_at(t[k], t[(k + 1) % 3])) {
          if (use.face != f) best = std::max(best, normal.dot(normal_of(positions, result_.mesh.triangles[use.face])));
        }
      }
      worst = std::min(worst, normal.isZero() ? -1.0 : best);
    }
    positions[move.vertex] = before;
    return worst;
  }

  const TriangleMesh& reference_;
  SimplifiedMesh& result_;
  Placement placement_;
  const RunContext& context_;
  std::optional<KdTree> places_;
  std::vector<Index> place_of_;     // point of the tree -> input vertex
  std::vector<std::uint8_t> used_;  // per input vertex
  std::vector<Neighbor> near_;
};

}  // namespace

std::vector<Index> turned_faces(const TriangleMesh& reference, const TriangleMesh& mesh, const EdgeUses& edges,
                                const RunContext& context) {
  std::vector<Vec3> normal(mesh.triangles.size());
  for (std::size_t f = 0; f < normal.size(); ++f) {
    poll(context, f);
    normal[f] = normal_of(mesh.positions, mesh.triangles[f]);
  }
  std::vector<std::uint8_t> has_neighbor(mesh.triangles.size(), 0), supported(mesh.triangles.size(), 0);
  std::vector<std::uint8_t> at_junction(mesh.positions.size(), 0);
  std::size_t visited = 0;
  edges.for_each([&](Index low, Index high, std::span<const EdgeUse> faces) {
    poll(context, visited++);
    if (faces.size() > 2) at_junction[low] = at_junction[high] = 1;
    for (const EdgeUse& f : faces) {
      for (const EdgeUse& g : faces) {
        if (f.face == g.face) continue;
        has_neighbor[f.face] = 1;
        if (normal[f.face].dot(normal[g.face]) > kFolded) supported[f.face] = 1;
      }
    }
  });
  std::optional<TriangleTree> tree;  // rarely needed
  std::vector<Index> turned;
  for (Index f = 0; f < normal.size(); ++f) {
    if (has_neighbor[f] == 0 || supported[f] != 0) continue;
    const auto& [a, b, c] = mesh.triangles[f];
    if (at_junction[a] || at_junction[b] || at_junction[c]) continue;
    context.check();
    if (!tree) tree.emplace(reference, context);
    if (looks_against(mesh, f, reference, *tree)) turned.push_back(f);
  }
  return turned;
}

std::size_t unfold_faces(const TriangleMesh& reference, SimplifiedMesh& result, Placement placement,
                         const FeatureEdges& features, const RunContext& context) {
  std::vector<std::uint8_t> is_feature(features.empty() ? 0 : reference.positions.size(), 0);
  for (const auto& [a, b] : features) is_feature[a] = is_feature[b] = 1;
  const auto is_fixed = [&](Index v) { return !is_feature.empty() && is_feature[result.source_vertex[v]] != 0; };
  TriangleMesh& mesh = result.mesh;
  Relocation relocation(reference, result, placement, context);
  for (int pass = 0;; ++pass) {
    const EdgeUses edges(mesh, context);
    const std::vector<Index> turned = turned_faces(reference, mesh, edges, context);
    if (turned.empty() || pass == kMaxPasses) return turned.size();
    std::vector<std::uint8_t> touched(mesh.positions.size(), 0);  // edges there are out of date until the next pass
    for (const Index f : turned) {
      context.check();
      const Triangle corners = mesh.triangles[f];
      if (const std::optional<Flip> flip = best_flip(mesh, edges, f, is_fixed)) {
        const std::array<Index, 4> quad = {flip->new_f[0], flip->new_f[1], flip->new_f[2], flip->new_g[2]};
        if (std::any_of(quad.begin(), quad.end(), [&](Index v) { return touched[v] != 0; })) continue;
        for (const Index v : quad) touched[v] = 1;
        mesh.triangles[flip->f] = flip->new_f;
        mesh.triangles[flip->g] = flip->new_g;
      } else if (std::none_of(corners.begin(), corners.end(), [&](Index v) { return touched[v] != 0; })) {
        for (const Index v : corners) touched[v] = 1;
        relocation.relocate(edges, corners, is_fixed);
      }
    }
  }
}

}  // namespace shapelight
