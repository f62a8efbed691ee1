#include "graph/finish_graph.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "graph/components.hpp"
#include "shapelight/spatial/kd_tree.hpp"

namespace shapelight {
namespace {

constexpr double kNearSurface = 3.0;  // [mean edge lengths] an isolated vertex farther from all others is a stray
constexpr double kFlat = 0.01;        // share of |n . (p - c)| that must agree on a side for the shape to decide

struct ComponentSide {
  Vec3 center = Vec3::Zero();
  double area = 0.0;
  double outward = 0.0;    // sum of area n . (p - c), or towards the viewpoint
  double magnitude = 0.0;  // sum of area |p - c|
  double up = 0.0;         // sum of area n_z

  [[nodiscard]] bool is_inside_out() const {
    const bool shape_decides = std::abs(outward) > kFlat * magnitude;
    return (shape_decides ? outward : up) < 0.0;
  }
};

// At the roots of the components.
std::vector<ComponentSide> component_sides(const SurfaceGraph& graph, const std::vector<Index>& root,
                                           const std::optional<Vec3>& viewpoint, const RunContext& context) {
  std::vector<ComponentSide> sides(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i) {
    poll(context, i);
    ComponentSide& side = sides[root[i]];
    side.center += graph.area[i] * graph.position[i];
    side.area += graph.area[i];
  }
  for (std::size_t i = 0; i < graph.size(); ++i) {
    poll(context, i);
    ComponentSide& side = sides[root[i]];
    const Vec3 center = viewpoint ? Vec3(*viewpoint - graph.origin) : Vec3(side.center / std::max(side.area, 1e-300));
    Vec3 outward = graph.position[i] - center;
    if (viewpoint) outward = -outward.normalized();
    side.outward += graph.area[i] * graph.normal[i].dot(outward);
    side.magnitude += graph.area[i] * outward.norm();
    side.up += graph.area[i] * graph.normal[i].z();
  }
  return sides;
}

// Isolated vertices that lie on the surface all the same, such as those that no triangle of a mesh uses, are no strays.
void flag_isolated(SurfaceGraph& graph, const RunContext& context) {
  std::vector<Index> isolated;
  std::vector<Vec3> connected;
  for (Index i = 0; i < graph.size(); ++i) {
    if (graph.neighbors_of(i).empty())
      isolated.push_back(i);
    else
      connected.push_back(graph.position[i]);
  }
  if (isolated.empty()) return;
  const KdTree tree(connected, context);
  const double reach = kNearSurface * graph.mean_edge_length;
  for (std::size_t k = 0; k < isolated.size(); ++k) {
    poll(context, k);
    const Index i = isolated[k];
    const Neighbor nearest = tree.nearest(graph.position[i]);
    graph.outlier[i] = nearest.index == kNoIndex || nearest.distance_sq > reach * reach;
  }
}

}  // namespace

void finish_graph(BuiltGraph& built, const RunContext& context) {
  SurfaceGraph& graph = built.graph;
  const std::size_t n = graph.size();
  const double length_sum = parallel::sum(context, n, [&](std::size_t i) {
    double sum = 0.0;
    for (const Index j : graph.neighbors_of(i)) sum += (graph.position[j] - graph.position[i]).norm();
    return sum;
  });
  graph.mean_edge_length = graph.neighbors.empty() ? 0.0 : length_sum / static_cast<double>(graph.neighbors.size());
  graph.total_area = parallel::sum(context, n, [&](std::size_t i) { return graph.area[i]; });

  flag_isolated(graph, context);
  GraphDiagnostics& counts = built.diagnostics;
  const std::vector<Index> root = component_roots(graph, context);
  for (std::size_t i = 0; i < n; ++i) {
    if (graph.neighbors_of(i).empty()) {
      ++counts.isolated_vertices;
    } else if (root[i] == i) {
      ++counts.components;
    }
    counts.outliers += graph.outlier[i];
    counts.boundary_vertices += graph.boundary[i];
  }
}

void orient_components(SurfaceGraph& graph, const std::optional<Vec3>& viewpoint, const RunContext& context) {
  const std::vector<Index> root = component_roots(graph, context);
  const std::vector<ComponentSide> sides = component_sides(graph, root, viewpoint, context);
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (sides[root[i]].is_inside_out()) graph.normal[i] = -graph.normal[i];
  }
}

void orient_as_one(SurfaceGraph& graph, const std::optional<Vec3>& viewpoint, const RunContext& context) {
  ComponentSide whole;
  for (const ComponentSide& side : component_sides(graph, component_roots(graph, context), viewpoint, context)) {
    whole.outward += side.outward;
    whole.magnitude += side.magnitude;
    whole.up += side.up;
  }
  if (!whole.is_inside_out()) return;
  for (Vec3& normal : graph.normal) normal = -normal;
}

}  // namespace shapelight
