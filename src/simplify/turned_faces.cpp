#include "simplify/turned_faces.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight {
namespace {

constexpr double kFolded = -0.9;   // cosine between the normals of faces that lie on each other
constexpr double kAgainst = -0.5;  // cosine from which a face looks against the input
constexpr double kNoArea = 1e-9;   // twice the area over the longest edge squared: no normal to speak of
constexpr int kMaxPasses = 4;

Vec3 normal_of(const std::vector<Vec3>& positions, const Triangle& t) {
  const Vec3 u = positions[t[1]] - positions[t[0]], v = positions[t[2]] - positions[t[0]];
  const Vec3 cross = u.cross(v);
  const double length = cross.norm();
  const double longest_sq = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
  return length > kNoArea * longest_sq ? Vec3(cross / length) : Vec3::Zero();
}

// Whether the face looks against the input at all of its places that are tried.
bool looks_against(const TriangleMesh& mesh, std::size_t face, const TriangleMesh& reference, const TriangleTree& tree) {
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

}  // namespace

std::vector<Index> turned_faces(const TriangleMesh& reference, const TriangleMesh& mesh, const EdgeUses& edges,
                                const RunContext& context) {
  std::vector<Vec3> normal(mesh.triangles.size());
  for (std::size_t f = 0; f < normal.size(); ++f) normal[f] = normal_of(mesh.positions, mesh.triangles[f]);
  std::vector<std::uint8_t> has_neighbor(mesh.triangles.size(), 0), supported(mesh.triangles.size(), 0);
  edges.for_each([&](Index, Index, std::span<const EdgeUse> faces) {
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
    if (!tree) tree.emplace(reference, context);
    if (looks_against(mesh, f, reference, *tree)) turned.push_back(f);
  }
  return turned;
}

std::size_t unfold_faces(const TriangleMesh& reference, SimplifiedMesh& result, const FeatureEdges& features,
                         const RunContext& context) {
  std::vector<std::uint8_t> is_feature(features.empty() ? 0 : reference.positions.size(), 0);
  for (const auto& [a, b] : features) is_feature[a] = is_feature[b] = 1;
  const auto is_fixed = [&](Index v) { return !is_feature.empty() && is_feature[result.source_vertex[v]] != 0; };
  TriangleMesh& mesh = result.mesh;
  for (int pass = 0;; ++pass) {
    const EdgeUses edges(mesh);
    const std::vector<Index> turned = turned_faces(reference, mesh, edges, context);
    if (turned.empty() || pass == kMaxPasses) return turned.size();
    std::vector<std::uint8_t> touched(mesh.positions.size(), 0);  // edges there are out of date until the next pass
    for (const Index f : turned) {
      std::optional<Flip> best;
      double best_fold = -1.0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (is_fixed(mesh.triangles[f][k]) && is_fixed(mesh.triangles[f][(k + 1) % 3])) continue;
        const std::optional<Flip> flip = flip_at(mesh, edges, f, k);
        if (!flip) continue;
        const double fold = worst_fold(mesh, edges, *flip);
        if (fold <= best_fold) continue;
        best_fold = fold;
        best = flip;
      }
      if (!best) continue;
      const std::array<Index, 4> corners = {best->new_f[0], best->new_f[1], best->new_f[2], best->new_g[2]};
      if (std::any_of(corners.begin(), corners.end(), [&](Index v) { return touched[v] != 0; })) continue;
      for (const Index v : corners) touched[v] = 1;
      mesh.triangles[best->f] = best->new_f;
      mesh.triangles[best->g] = best->new_g;
    }
  }
}

}  // namespace shapelight
