#include "graph/canonical_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.hpp"

namespace shapelight {
namespace {

struct Keyed {
  std::uint64_t morton;
  Index point;
};

// Spreads the low 21 bits so that two zero bits follow each.
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

// Least significant digit first; stable, so equal keys stay in the order of the points.
void radix_sort(std::vector<Keyed>& items, const RunContext& context) {
  constexpr int kDigitBits = 11;
  std::vector<Keyed> other(items.size());
  for (int shift = 0; shift < 63; shift += kDigitBits) {
    context.check();
    std::vector<std::size_t> start(1U << kDigitBits, 0);
    const auto digit = [shift](const Keyed& k) { return (k.morton >> shift) & ((1U << kDigitBits) - 1); };
    for (const Keyed& k : items) ++start[digit(k)];
    std::size_t sum = 0;
    for (std::size_t& s : start) sum += std::exchange(s, sum);
    for (const Keyed& k : items) other[start[digit(k)]++] = k;
    items.swap(other);
  }
}

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

std::vector<Keyed> morton_keys(std::span<const Vec3> positions, const BoundingBox& box, const RunContext& context) {
  const double extent = (box.max - box.min).maxCoeff();
  const double scale = extent > 0.0 ? 0x1fffff / extent : 0.0;
  std::vector<Keyed> keys(positions.size());
  parallel::for_chunks(context, positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      keys[i] = {~0ULL, static_cast<Index>(i)};
      if (!positions[i].allFinite()) continue;
      const Vec3 cell = (positions[i] - box.min) * scale;
      keys[i].morton = spread(static_cast<std::uint64_t>(cell.x())) |
                       spread(static_cast<std::uint64_t>(cell.y())) << 1 |
                       spread(static_cast<std::uint64_t>(cell.z())) << 2;
    }
  });
  std::erase_if(keys, [](const Keyed& k) { return k.morton == ~0ULL; });
  return keys;
}

// Points in one Morton cell: by coordinates, so that duplicates meet and the order of the input does not matter.
void sort_ties(std::vector<Keyed>& keys, std::span<const Vec3> positions, const RunContext& context) {
  context.check();
  for (std::size_t begin = 0; begin < keys.size();) {
    std::size_t end = begin + 1;
    while (end < keys.size() && keys[end].morton == keys[begin].morton) ++end;
    if (end - begin > 1) {
      std::stable_sort(keys.begin() + begin, keys.begin() + end,
                       [&](const Keyed& a, const Keyed& b) { return before(positions[a.point], positions[b.point]); });
    }
    begin = end;
  }
}

}  // namespace

BuiltGraph graph_of_places(std::span<const Vec3> positions, const RunContext& context) {
  return start_graph(positions, context);
}

BuiltGraph start_graph(std::span<const Vec3> positions, const RunContext& context) {
  BuiltGraph built;
  SurfaceGraph& graph = built.graph;
  const BoundingBox box = bounding_box(positions);
  std::vector<Keyed> keys = morton_keys(positions, box, context);
  radix_sort(keys, context);
  sort_ties(keys, positions, context);

  graph.origin = box.center();
  graph.vertex_of_point.assign(positions.size(), kNoIndex);
  graph.global_id.reserve(keys.size());
  context.check();
  for (const Keyed& key : keys) {
    const bool repeated = !graph.global_id.empty() && positions[graph.global_id.back()] == positions[key.point];
    if (!repeated) graph.global_id.push_back(key.point);
    graph.vertex_of_point[key.point] = static_cast<Index>(graph.global_id.size() - 1);
  }
  const std::size_t n = graph.global_id.size();
  built.diagnostics.non_finite_points = positions.size() - keys.size();
  built.diagnostics.duplicate_points = keys.size() - n;

  context.check();
  graph.position.resize(n);
  for (std::size_t i = 0; i < n; ++i) graph.position[i] = positions[graph.global_id[i]] - graph.origin;
  graph.normal.assign(n, Vec3::Zero());
  graph.area.assign(n, 0.0);
  graph.boundary.assign(n, 0);
  graph.outlier.assign(n, 0);
  graph.offsets.assign(n + 1, 0);
  return built;
}

}  // namespace shapelight
