#include "graph/components.hpp"

#include "core/poll.hpp"

namespace shapelight {

std::vector<Index> component_roots(const SurfaceGraph& graph, const RunContext& context) {
  SignedUnionFind sets(graph.size());
  for (Index i = 0; i < graph.size(); ++i) {
    poll(context, i);
    for (const Index j : graph.neighbors_of(i)) {
      if (j > i) break;
      sets.unite(i, j);
    }
  }
  std::vector<Index> root(graph.size());
  for (Index i = 0; i < graph.size(); ++i) root[i] = sets.find(i).first;
  return root;
}

}  // namespace shapelight
