#include "simplify/check_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/poll.hpp"
#include "shapelight/core/error.hpp"
#include "simplify/edge_uses.hpp"
#include "simplify/manifold_mesh.hpp"
#include "simplify/turned_faces.hpp"

namespace shapelight {
namespace {

// What collapses must not change.
struct Topology {
  std::ptrdiff_t euler = 0;  // vertices - edges + faces
  std::size_t borders = 0;   // connected lines of edges with one face
};

Topology topology_of(const TriangleMesh& mesh, const EdgeUses& edges) {
  Topology topology;
  topology.euler = static_cast<std::ptrdiff_t>(mesh.positions.size() + mesh.triangles.size());
  std::vector<Index> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<std::uint8_t> on_border(mesh.positions.size(), 0);
  edges.for_each([&](Index low, Index high, std::span<const EdgeUse> faces) {
    --topology.euler;
    if (faces.size() != 1) return;
    on_border[low] = on_border[high] = 1;
    parent[root(low)] = root(high);
  });
  for (Index v = 0; v < parent.size(); ++v) topology.borders += on_border[v] != 0 && parent[v] == v;
  return topology;
}

void check_count(const SimplifiedMesh& result, const SimplifyTarget& target) {
  const std::size_t vertices = result.mesh.positions.size(), faces = result.mesh.triangles.size();
  if (target.vertices != 0 && vertices != target.vertices) {
    throw PostconditionFailed(fmt::format("simplified to {} vertices, expected {}", vertices, target.vertices));
  }
  if (target.faces != 0 && (faces > target.faces + 1 || faces + 1 < target.faces)) {
    throw PostconditionFailed(fmt::format("simplified to {} faces, expected {} within one", faces, target.faces));
  }
}

void check_vertices(const SimplifiedMesh& reference, const SimplifiedMesh& result, Placement placement,
                    const RunContext& context) {
  const std::size_t n = result.mesh.positions.size();
  if (result.source_vertex.size() != n) {
    throw PostconditionFailed(fmt::format("{} sources for {} vertices", result.source_vertex.size(), n));
  }
  std::vector<std::uint8_t> used(n, 0);
  for (std::size_t f = 0; f < result.mesh.triangles.size(); ++f) {
    poll(context, f);
    const Triangle& t = result.mesh.triangles[f];
    if (std::max({t[0], t[1], t[2]}) >= n) throw PostconditionFailed(fmt::format("face {}: vertex >= {}", f, n));
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      throw PostconditionFailed(fmt::format("face {}: vertices {} {} {}, expected three", f, t[0], t[1], t[2]));
    }
    for (const Index v : t) used[v] = 1;
  }
  Index highest = 0;
  for (const Index s : reference.source_vertex) highest = std::max(highest, s);
  std::vector<Index> vertex_of(std::size_t{highest} + 1, kNoIndex);
  for (Index v = 0; v < reference.source_vertex.size(); ++v) vertex_of[reference.source_vertex[v]] = v;
  for (std::size_t v = 0; v < n; ++v) {
    poll(context, v);
    const Index source = result.source_vertex[v];
    if (used[v] == 0) throw PostconditionFailed(fmt::format("vertex {} is in no face", v));
    if (!result.mesh.positions[v].allFinite()) throw PostconditionFailed(fmt::format("vertex {} is not finite", v));
    if (source > highest || vertex_of[source] == kNoIndex) {
      throw PostconditionFailed(fmt::format("vertex {}: source {} is in no face of the input", v, source));
    }
    if (placement == Placement::Input && result.mesh.positions[v] != reference.mesh.positions[vertex_of[source]]) {
      throw PostconditionFailed(fmt::format("vertex {} is not where its source {} is", v, source));
    }
  }
}

void check_duplicate_faces(const TriangleMesh& mesh, const RunContext& context) {
  // Equal faces share their lowest vertex; few faces have the same one.
  std::vector<std::size_t> offsets(mesh.positions.size() + 1, 0);
  for (const Triangle& t : mesh.triangles) ++offsets[std::min({t[0], t[1], t[2]}) + 1];
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
  std::vector<Triangle> sorted(mesh.triangles.size());
  for (Triangle t : mesh.triangles) {
    std::sort(t.begin(), t.end());
    sorted[next[t[0]]++] = t;
  }
  for (std::size_t v = 0; v + 1 < offsets.size(); ++v) {
    poll(context, v);
    const auto begin = sorted.begin() + static_cast<std::ptrdiff_t>(offsets[v]);
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(offsets[v + 1]);
    std::sort(begin, end);
    const auto twice = std::adjacent_find(begin, end);
    if (twice != end) {
      throw PostconditionFailed(fmt::format("two faces over vertices {} {} {}", (*twice)[0], (*twice)[1], (*twice)[2]));
    }
  }
}

// Pairs of input vertices whose edges have more than two faces, sorted.
std::vector<std::array<Index, 2>> crowded_edges(const SimplifiedMesh& mesh, const EdgeUses& edges) {
  std::vector<std::array<Index, 2>> crowded;
  edges.for_each([&](Index low, Index high, std::span<const EdgeUse> faces) {
    if (faces.size() <= 2) return;
    const auto [a, b] = std::minmax(mesh.source_vertex[low], mesh.source_vertex[high]);
    crowded.push_back({a, b});
  });
  std::sort(crowded.begin(), crowded.end());
  return crowded;
}

void check_edges(const SimplifiedMesh& reference, const SimplifiedMesh& result, const EdgeUses& edges_in,
                 const EdgeUses& edges_out, const RunContext& context) {
  // The ends of such an edge may have moved, so only their number tells.
  const auto before = crowded_edges(reference, edges_in), after = crowded_edges(result, edges_out);
  if (after.size() > before.size()) {
    const auto fresh = std::find_if(after.begin(), after.end(), [&](const std::array<Index, 2>& edge) {
      return !std::binary_search(before.begin(), before.end(), edge);
    });
    const auto& [a, b] = fresh == after.end() ? after.front() : *fresh;
    throw PostconditionFailed(
        fmt::format("{} edges with more than two faces, expected at most the input's {}; one is "
                    "from input vertex {} to {}",
                    after.size(), before.size(), a, b));
  }
  context.check();
  const Topology in = topology_of(reference.mesh, edges_in), out = topology_of(result.mesh, edges_out);
  if (out.euler != in.euler) {
    throw PostconditionFailed(fmt::format("Euler characteristic {}, expected the input's {}", out.euler, in.euler));
  }
  if (out.borders > in.borders) {
    throw PostconditionFailed(fmt::format("{} borders, expected at most the input's {}", out.borders, in.borders));
  }
}

}  // namespace

SimplifiedMesh without_oddities(const TriangleMesh& mesh, MeshOddities& oddities, const RunContext& context) {
  return simplification::merge_copies(simplification::make_manifold(mesh, {}, context, &oddities));
}

void check_result(const SimplifiedMesh& reference, const SimplifiedMesh& result, const SimplifyTarget& target,
                  Placement placement, const RunContext& context) {
  check_count(result, target);
  check_vertices(reference, result, placement, context);
  check_duplicate_faces(result.mesh, context);
  const EdgeUses edges_in(reference.mesh, context), edges_out(result.mesh, context);
  context.check();
  check_edges(reference, result, edges_in, edges_out, context);
  const std::vector<Index> turned = turned_faces(reference.mesh, result.mesh, edges_out, context);
  if (!turned.empty() && turned.size() > turned_faces(reference.mesh, reference.mesh, edges_in, context).size()) {
    throw PostconditionFailed(
        fmt::format("face {} is turned over: it looks against its neighbours and the input", turned.front()));
  }
}

}  // namespace shapelight
