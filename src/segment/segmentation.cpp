#include "shapelight/segment/segmentation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/poll.hpp"
#include "graph/field_checks.hpp"

namespace shapelight {
namespace {

struct WeightedEdge {
  float weight;
  Index a, b;  // a < b
};

// Stable radix sort: edges come in the order (a, b), so they leave in the order (weight, a, b). Non-negative floats
// sort like their bits.
void sort_by_weight(std::vector<WeightedEdge>& edges, const RunContext& context) {
  constexpr std::uint32_t kBits = 11, kMask = (1U << kBits) - 1;
  std::vector<WeightedEdge> other(edges.size());
  for (std::uint32_t shift = 0; shift < 32; shift += kBits) {
    context.check();
    const auto digit = [shift](const WeightedEdge& e) {
      return (std::bit_cast<std::uint32_t>(e.weight) >> shift) & kMask;
    };
    std::array<std::size_t, kMask + 2> start{};
    for (const WeightedEdge& e : edges) ++start[digit(e) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    context.check();
    for (const WeightedEdge& e : edges) other[start[digit(e)]++] = e;
    edges.swap(other);
  }
}

std::vector<WeightedEdge> sorted_edges(const SurfaceGraph& graph, std::span<const double> field,
                                       const RunContext& context) {
  std::vector<WeightedEdge> edges;
  edges.reserve(graph.neighbors.size() / 2);
  for (std::size_t i = 0; i < graph.size(); ++i) {
    poll(context, i);
    for (const Index j : graph.neighbors_of(i)) {
      if (i < j) edges.push_back({static_cast<float>(std::abs(field[i] - field[j])), static_cast<Index>(i), j});
    }
  }
  sort_by_weight(edges, context);
  return edges;
}

// Disjoint sets with the size and the internal difference Int (eq. 12) of each.
class Segments {
 public:
  explicit Segments(std::size_t n) : parent_(n), size_(n, 1), internal_(n, 0.0f) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index find(Index v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  // Edges come by rising weight, so the heaviest of the joint spanning tree is the one that joins.
  void join(Index a, Index b, float weight) {
    if (size_[a] < size_[b]) std::swap(a, b);
    parent_[b] = a;
    size_[a] += size_[b];
    internal_[a] = std::max(internal_[a], weight);
  }
  [[nodiscard]] std::size_t size(Index root) const { return size_[root]; }
  // Int(R) + tau(R) of eq. 11.
  [[nodiscard]] double tolerance(Index root, double scale) const {
    return static_cast<double>(internal_[root]) + scale / static_cast<double>(size_[root]);
  }

 private:
  std::vector<Index> parent_;
  std::vector<Index> size_;
  std::vector<float> internal_;
};

SegmentationResult number_by_lowest_vertex(Segments& segments, std::size_t n) {
  SegmentationResult result;
  result.label.resize(n);
  std::vector<std::uint32_t> label_of_root(n, kNoIndex);
  for (std::size_t i = 0; i < n; ++i) {
    std::uint32_t& label = label_of_root[segments.find(static_cast<Index>(i))];
    if (label == kNoIndex) label = static_cast<std::uint32_t>(result.count++);
    result.label[i] = label;
  }
  return result;
}

}  // namespace

SegmentationResult segment_field(const SurfaceGraph& graph, std::span<const double> field,
                                 const SegmentationOptions& options, const RunContext& context) {
  validate_options(options);
  check_field(graph, field, "field");
  const std::size_t n = graph.size();
  const std::vector<WeightedEdge> edges = sorted_edges(graph, field, context);

  Segments segments(n);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    poll(context, i);
    const WeightedEdge& e = edges[i];
    const Index a = segments.find(e.a), b = segments.find(e.b);
    if (a == b) continue;
    const double least = std::min(segments.tolerance(a, options.scale), segments.tolerance(b, options.scale));
    if (static_cast<double>(e.weight) <= least) segments.join(a, b, e.weight);  // no boundary, eq. 9
  }

  const double smallest = std::max(static_cast<double>(options.min_points), options.min_share * static_cast<double>(n));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    poll(context, i);
    const WeightedEdge& e = edges[i];
    const Index a = segments.find(e.a), b = segments.find(e.b);
    if (a != b && static_cast<double>(std::min(segments.size(a), segments.size(b))) < smallest)
      segments.join(a, b, e.weight);
  }
  return number_by_lowest_vertex(segments, n);
}

}  // namespace shapelight
