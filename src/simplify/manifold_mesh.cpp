#include "simplify/manifold_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "shapelight/core/error.hpp"
#include "simplify/sheets.hpp"
#include "simplify/wedges.hpp"

namespace shapelight::simplification {
namespace {

// Checks every index and every vertex in use; returns the faces that name three different vertices.
std::vector<Triangle> usable_triangles(const TriangleMesh& mesh, const RunContext& context, MeshOddities& oddities) {
  const auto& [positions, triangles] = mesh;
  const auto is_degenerate = [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
  oddities.degenerate_faces += parallel::reduce_chunks(
      context, triangles.size(), std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t degenerate = 0;
        for (std::size_t f = begin; f < end; ++f) {
          for (const Index v : triangles[f]) {
            if (v >= positions.size()) {
              throw InvalidInput(fmt::format("triangle {}: vertex {} >= {} vertices", f, v, positions.size()));
            }
            if (!positions[v].allFinite()) {
              throw InvalidInput(fmt::format("triangle {}: vertex {} is not finite", f, v));
            }
          }
          degenerate += is_degenerate(triangles[f]);
        }
        return degenerate;
      },
      std::plus<>());
  context.check();
  std::vector<Triangle> usable(triangles);
  std::erase_if(usable, is_degenerate);
  return usable;
}

// Puts every vertex's faces in order. True when each used vertex is one fan: the mesh is an oriented manifold.
bool order_fans(Wedges& wedges, std::span<Fan> fans, const RunContext& context) {
  const std::size_t irregular = parallel::reduce_chunks(
      context, wedges.num_vertices(), std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t v = begin; v < end; ++v) {
          fans[v] = order_fan(wedges.at(v));
          count += fans[v] == Fan::Irregular && !wedges.at(v).empty();
        }
        return count;
      },
      std::plus<>());
  return irregular == 0;
}

// A manifold already: every used vertex stays one vertex.
Sheets pass_through(const Wedges& wedges, std::vector<Triangle>&& triangles, const RunContext& context) {
  Sheets sheets;
  sheets.triangles = std::move(triangles);
  std::vector<Index> number(wedges.num_vertices(), kNoIndex);
  for (Index v = 0; v < number.size(); ++v) {
    poll(context, v);
    if (wedges.at(v).empty()) continue;
    number[v] = static_cast<Index>(sheets.source.size());
    sheets.source.push_back(v);
  }
  sheets.locked.assign(sheets.source.size(), 0);
  if (sheets.source.size() == number.size()) return sheets;
  parallel::for_chunks(context, sheets.triangles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      for (Index& v : sheets.triangles[f]) v = number[v];
    }
  });
  return sheets;
}

std::uint64_t edge_key(Index a, Index b) { return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b); }

std::vector<std::uint64_t> sorted_keys(const FeatureEdges& features, std::size_t num_vertices) {
  std::vector<std::uint64_t> keys;
  for (const auto& [a, b] : features) {
    if (std::max(a, b) >= num_vertices) {
      throw InvalidInput(
          fmt::format("feature edge {}: vertex {} >= {} vertices", keys.size(), std::max(a, b), num_vertices));
    }
    keys.push_back(edge_key(a, b));
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

// Finds every vertex's neighbours along borders and features: two make a line, any other number locks the vertex.
void mark_lines(ManifoldMesh& mesh, const Wedges& wedges, std::span<const Fan> fans, const FeatureEdges& features,
                std::size_t num_input_vertices, const RunContext& context) {
  const std::size_t n = mesh.source.size();
  const std::vector<std::uint64_t> keys = sorted_keys(features, num_input_vertices);
  std::vector<std::uint8_t> on_feature(keys.empty() ? 0 : num_input_vertices, 0);
  for (const std::uint64_t key : keys) on_feature[key >> 32] = on_feature[key & 0xffffffffu] = 1;
  mesh.line.assign(n, {kNoIndex, kNoIndex});
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      std::array<Index, 2> line{kNoIndex, kNoIndex};
      std::size_t count = 0;
      const auto add = [&](Index w) {
        if (count < 2) line[count] = w;
        ++count;
      };
      const auto fan = wedges.at(v);
      if (fans[v] == Fan::Open) {
        add(fan.front().next);
        add(fan.back().previous);
      }
      if (!keys.empty() && on_feature[mesh.source[v]]) {
        for (std::size_t i = fans[v] == Fan::Open ? 1 : 0; i < fan.size(); ++i) {
          const Index w = fan[i].next;
          if (on_feature[mesh.source[w]] &&
              std::binary_search(keys.begin(), keys.end(), edge_key(mesh.source[v], mesh.source[w]))) {
            add(w);
          }
        }
      }
      if (count != 0 && count != 2) mesh.locked[v] = 1;
      if (count == 2 && !mesh.locked[v]) mesh.line[v] = line;
    }
  });
}

// (source, vertex) of the locked vertices, sorted: copies of one input vertex are neighbours.
std::vector<std::pair<Index, Index>> locked_by_source(const ManifoldMesh& mesh) {
  std::vector<std::pair<Index, Index>> locked;
  for (Index v = 0; v < mesh.locked.size(); ++v) {
    if (mesh.locked[v]) locked.emplace_back(mesh.source[v], v);
  }
  std::sort(locked.begin(), locked.end());
  return locked;
}

}  // namespace

ManifoldMesh make_manifold(const TriangleMesh& mesh, const FeatureEdges& features, const RunContext& context,
                           MeshOddities* oddities) {
  MeshOddities met;
  std::vector<Triangle> triangles = usable_triangles(mesh, context, met);
  Wedges wedges = collect_wedges(mesh.positions.size(), triangles, context);
  std::vector<Fan> fans(mesh.positions.size());
  for (std::size_t v = 0; v < fans.size(); ++v) met.unused_vertices += wedges.at(v).empty();
  const bool is_manifold = order_fans(wedges, fans, context);
  Sheets sheets = is_manifold ? pass_through(wedges, std::move(triangles), context)
                              : cut_into_sheets(mesh.positions, std::move(triangles), met, context);
  met.split_vertices = sheets.source.size() - (mesh.positions.size() - met.unused_vertices);
  met.locked_vertices = static_cast<std::size_t>(std::count(sheets.locked.begin(), sheets.locked.end(), 1));
  if (!is_manifold || met.unused_vertices != 0) {
    wedges = collect_wedges(sheets.source.size(), sheets.triangles, context);
    fans.resize(sheets.source.size());
    order_fans(wedges, fans, context);
  }

  ManifoldMesh result;
  result.mesh.triangles = std::move(sheets.triangles);
  result.source = std::move(sheets.source);
  result.locked = std::move(sheets.locked);
  if (met.locked_vertices > 0) {
    result.junction.resize(result.source.size());
    for (std::size_t v = 0; v < result.source.size(); ++v) {
      result.junction[v] = result.locked[v] != 0 ? result.source[v] : kNoIndex;
    }
  }
  result.mesh.positions.resize(result.source.size());
  parallel::for_chunks(context, result.source.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) result.mesh.positions[v] = mesh.positions[result.source[v]];
  });
  mark_lines(result, wedges, fans, features, mesh.positions.size(), context);
  if (oddities) *oddities = met;
  return result;
}

SimplifiedMesh merge_copies(ManifoldMesh&& mesh) {
  const std::size_t n = mesh.source.size();
  std::vector<Index> representative(n);
  std::iota(representative.begin(), representative.end(), Index{0});
  const auto locked = locked_by_source(mesh);
  for (std::size_t i = 1; i < locked.size(); ++i) {
    if (locked[i].first == locked[i - 1].first) representative[locked[i].second] = representative[locked[i - 1].second];
  }
  std::vector<std::uint8_t> used(n, 0);
  for (Triangle& t : mesh.mesh.triangles) {
    for (Index& v : t) v = representative[v];
  }
  // Two copies of one vertex may have become neighbours.
  std::erase_if(mesh.mesh.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  for (const Triangle& t : mesh.mesh.triangles) used[t[0]] = used[t[1]] = used[t[2]] = 1;

  std::vector<Index> order;
  for (Index v = 0; v < n; ++v) {
    if (used[v]) order.push_back(v);
  }
  const auto by_source = [&](Index a, Index b) { return mesh.source[a] < mesh.source[b]; };
  if (!std::is_sorted(order.begin(), order.end(), by_source)) std::stable_sort(order.begin(), order.end(), by_source);

  SimplifiedMesh result;
  std::vector<Index>& number = representative;
  for (const Index v : order) {
    number[v] = static_cast<Index>(result.source_vertex.size());
    result.source_vertex.push_back(mesh.source[v]);
    result.mesh.positions.push_back(mesh.mesh.positions[v]);
  }
  result.mesh.triangles = std::move(mesh.mesh.triangles);
  for (Triangle& t : result.mesh.triangles) {
    for (Index& v : t) v = number[v];
  }
  return result;
}

std::size_t num_merged_vertices(const ManifoldMesh& mesh) {
  const auto locked = locked_by_source(mesh);
  std::size_t copies = 0;
  for (std::size_t i = 1; i < locked.size(); ++i) copies += locked[i].first == locked[i - 1].first;
  return mesh.source.size() - copies;
}

}  // namespace shapelight::simplification
