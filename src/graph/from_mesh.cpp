#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "graph/canonical_order.hpp"
#include "graph/components.hpp"
#include "graph/finish_graph.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

// One corner of a triangle, seen from its vertex: the next two vertices around the triangle.
struct Corner {
  Index next, previous;
  friend auto operator<=>(const Corner&, const Corner&) = default;
};

// Corners by vertex, flat. Sorted within a vertex, so that the order of the triangles cannot change any sum.
struct Corners {
  std::vector<std::uint32_t> offsets;
  std::vector<Corner> items;
  [[nodiscard]] std::span<const Corner> at(std::size_t i) const {
    return {items.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
};

// Triangles over the graph's vertices; degenerate ones and those at non-finite points are gone.
std::vector<Triangle> usable_triangles(BuiltGraph& built, std::span<const Triangle> triangles,
                                       const RunContext& context) {
  const SurfaceGraph& graph = built.graph;
  std::vector<Triangle> usable;
  usable.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    poll(context, t);
    Triangle mapped;
    bool finite = true;
    for (int c = 0; c < 3; ++c) {
      if (triangles[t][c] >= graph.vertex_of_point.size()) {
        throw InvalidInput(
            fmt::format("triangle {}: vertex {} >= {} vertices", t, triangles[t][c], graph.vertex_of_point.size()));
      }
      mapped[c] = graph.vertex_of_point[triangles[t][c]];
      finite = finite && mapped[c] != kNoIndex;
    }
    if (!finite) continue;
    const bool repeated = mapped[0] == mapped[1] || mapped[1] == mapped[2] || mapped[2] == mapped[0];
    const auto edge = [&](int c) { return Vec3(graph.position[mapped[c]] - graph.position[mapped[0]]); };
    if (repeated || edge(1).cross(edge(2)).squaredNorm() == 0.0) {
      ++built.diagnostics.degenerate_triangles;
    } else {
      usable.push_back(mapped);
    }
  }
  return usable;
}

Corners collect_corners(std::size_t n, std::span<const Triangle> triangles, const RunContext& context) {
  Corners corners;
  corners.offsets.assign(n + 1, 0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    poll(context, i);
    for (const Index v : triangles[i]) ++corners.offsets[v + 1];
  }
  for (std::size_t i = 0; i < n; ++i) corners.offsets[i + 1] += corners.offsets[i];
  corners.items.resize(3 * triangles.size());
  std::vector<std::uint32_t> next(corners.offsets.begin(), corners.offsets.end() - 1);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    poll(context, i);
    const Triangle& t = triangles[i];
    for (int c = 0; c < 3; ++c) corners.items[next[t[c]]++] = {t[(c + 1) % 3], t[(c + 2) % 3]};
  }
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::sort(corners.items.begin() + corners.offsets[i], corners.items.begin() + corners.offsets[i + 1]);
    }
  });
  return corners;
}

struct EdgeEnd {
  Index neighbor;
  std::uint32_t triangles;
  double area;
};

// The edges at vertex i, ascending by neighbour, with the number and the area of their triangles.
void edges_of(const SurfaceGraph& graph, const Corners& corners, std::size_t i, std::vector<EdgeEnd>& edges) {
  edges.clear();
  for (const Corner& corner : corners.at(i)) {
    const Vec3 a = graph.position[corner.next] - graph.position[i];
    const Vec3 b = graph.position[corner.previous] - graph.position[i];
    const double area = 0.5 * a.cross(b).norm();
    edges.push_back({corner.next, 1, area});
    edges.push_back({corner.previous, 1, area});
  }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const EdgeEnd& a, const EdgeEnd& b) { return a.neighbor < b.neighbor; });
  std::size_t kept = 0;
  for (const EdgeEnd& edge : edges) {
    if (kept > 0 && edges[kept - 1].neighbor == edge.neighbor) {
      edges[kept - 1].triangles += 1;
      edges[kept - 1].area += edge.area;
    } else {
      edges[kept++] = edge;
    }
  }
  edges.resize(kept);
}

void fill_vertex(SurfaceGraph& graph, const Corners& corners, std::size_t i) {
  Vec3 normal = Vec3::Zero();
  double area = 0.0;
  for (const Corner& corner : corners.at(i)) {
    const Vec3 a = graph.position[corner.next] - graph.position[i];
    const Vec3 b = graph.position[corner.previous] - graph.position[i];
    const Vec3 cross = a.cross(b);
    normal += cross;
    area += cross.norm() / 6.0;  // a third of the triangle
  }
  const double length = normal.norm();
  graph.normal[i] = length > 0.0 ? Vec3(normal / length) : Vec3::Zero();
  graph.area[i] = area;
}

void fill_edges(BuiltGraph& built, const Corners& corners, const RunContext& context) {
  SurfaceGraph& graph = built.graph;
  const std::size_t n = graph.size();
  std::vector<std::uint32_t> degree(n);
  const auto count = [&](std::size_t begin, std::size_t end) {
    std::vector<EdgeEnd> edges;
    std::size_t non_manifold = 0;
    for (std::size_t i = begin; i < end; ++i) {
      edges_of(graph, corners, i, edges);
      degree[i] = static_cast<std::uint32_t>(edges.size());
      for (const EdgeEnd& edge : edges) {
        if (edge.triangles == 1) graph.boundary[i] = 1;
        non_manifold += edge.triangles > 2 && edge.neighbor > i;
      }
      fill_vertex(graph, corners, i);
    }
    return non_manifold;
  };
  built.diagnostics.non_manifold_edges =
      parallel::reduce_chunks(context, n, std::size_t{0}, count, [](std::size_t a, std::size_t b) { return a + b; });
  for (std::size_t i = 0; i < n; ++i) graph.offsets[i + 1] = graph.offsets[i] + degree[i];
  graph.neighbors.resize(graph.offsets[n]);
  graph.weight.resize(graph.offsets[n]);
  parallel::for_chunks(context, n, [&](std::size_t begin, std::size_t end) {
    std::vector<EdgeEnd> edges;
    for (std::size_t i = begin; i < end; ++i) {
      edges_of(graph, corners, i, edges);
      for (std::size_t k = 0; k < edges.size(); ++k) {
        graph.neighbors[graph.offsets[i] + k] = edges[k].neighbor;
        graph.weight[graph.offsets[i] + k] = static_cast<float>(edges[k].area);
      }
    }
  });
}

// Closed components whose signed volume is negative wind inwards.
void turn_outwards(SurfaceGraph& graph, const Corners& corners, const RunContext& context) {
  const std::vector<Index> root = component_roots(graph, context);
  std::vector<double> volume(graph.size(), 0.0);
  std::vector<std::uint8_t> open(graph.size(), 0);
  for (Index i = 0; i < graph.size(); ++i) {
    poll(context, i);
    // Relative to a vertex of the component, so that a small part far from the origin loses no digits.
    const Vec3& base = graph.position[root[i]];
    for (const auto& [next, previous] : corners.at(i)) {
      if (i > next || i > previous) continue;  // each triangle once, at its lowest vertex
      volume[root[i]] +=
          (graph.position[i] - base).dot((graph.position[next] - base).cross(graph.position[previous] - base));
    }
  }
  for (std::size_t i = 0; i < graph.size(); ++i) open[root[i]] |= graph.boundary[i];
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (open[root[i]] == 0 && volume[root[i]] < 0.0) graph.normal[i] = -graph.normal[i];
  }
}

}  // namespace

BuiltGraph graph_from_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                           const RunContext& context) {
  BuiltGraph built = start_graph(positions, context);
  const std::vector<Triangle> usable = usable_triangles(built, triangles, context);
  const Corners corners = collect_corners(built.graph.size(), usable, context);
  fill_edges(built, corners, context);
  turn_outwards(built.graph, corners, context);
  finish_graph(built, context);
  return built;
}

}  // namespace shapelight
