#include "sample/farthest_tree.hpp"

#include <algorithm>
#include <limits>

namespace shapelight {
namespace {

constexpr std::uint32_t kLeafSize = 8;     // measured: 16 and 32 are 1.7 times slower over a whole ranking
constexpr std::uint32_t kPollSize = 4096;  // smaller subtrees are built without a look at the stop token
constexpr double kFar = std::numeric_limits<double>::max();

}  // namespace

FarthestTree::FarthestTree(std::span<const Vec3> points, std::span<const double> weights, const RunContext& context)
    : weight_(points.size(), 1.0), distance_sq_(points.size(), kFar), index_(points.size()), slot_(points.size()) {
  for (std::size_t i = 0; i < points.size(); ++i) index_[i] = static_cast<Index>(i);
  nodes_.reserve(points.size() / (kLeafSize / 4) + 2);
  if (!points.empty()) build(0, static_cast<std::uint32_t>(points.size()), points, context);
  x_.resize(points.size());
  y_.resize(points.size());
  z_.resize(points.size());
  for (std::uint32_t slot = 0; slot < points.size(); ++slot) {
    const Index i = index_[slot];
    x_[slot] = points[i].x();
    y_[slot] = points[i].y();
    z_[slot] = points[i].z();
    slot_[i] = slot;
    if (!weights.empty()) weight_[slot] = weights[i];
  }
}

std::uint32_t FarthestTree::build(std::uint32_t begin, std::uint32_t end, std::span<const Vec3> points,
                                  const RunContext& context) {
  if (end - begin > kPollSize) context.check();
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  Vec3 min = points[index_[begin]];
  Vec3 max = min;
  for (std::uint32_t slot = begin + 1; slot < end; ++slot) {
    min = min.cwiseMin(points[index_[slot]]);
    max = max.cwiseMax(points[index_[slot]]);
  }
  nodes_.push_back(
      {{min.x(), min.y(), min.z()}, {max.x(), max.y(), max.z()}, {kFar, begin}, {kFar, begin}, begin, end, 0});
  if (end - begin <= kLeafSize) return id;
  int axis = 0;
  (max - min).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(index_.begin() + begin, index_.begin() + middle, index_.begin() + end, [&](Index a, Index b) {
    const double ca = points[a][axis];
    const double cb = points[b][axis];
    return ca < cb || (ca == cb && a < b);
  });
  build(begin, middle, points, context);
  const std::uint32_t right = build(middle, end, points, context);
  nodes_[id].right = right;
  return id;
}

void FarthestTree::choose(Index point) {
  const std::uint32_t slot = slot_[point];
  update(0, {x_[slot], y_[slot], z_[slot]});
}

bool FarthestTree::update(std::uint32_t id, const std::array<double, 3>& chosen) {
  Node& node = nodes_[id];
  double box_sq = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double outside = std::max({node.min[axis] - chosen[axis], 0.0, chosen[axis] - node.max[axis]});
    box_sq += outside * outside;
  }
  if (box_sq >= node.far.value) return false;  // nobody below can come closer
  if (node.right == 0) return update_leaf(node, chosen);
  const bool left = update(id + 1, chosen);
  const bool right = update(node.right, chosen);
  if (!left && !right) return false;
  const Node& a = nodes_[id + 1];
  const Node& b = nodes_[node.right];
  node.far = better(b.far, a.far) ? b.far : a.far;
  node.weighted = better(b.weighted, a.weighted) ? b.weighted : a.weighted;
  return true;
}

bool FarthestTree::update_leaf(Node& leaf, const std::array<double, 3>& chosen) {
  bool changed = false;
  for (std::uint32_t slot = leaf.begin; slot < leaf.end; ++slot) {
    const double dx = x_[slot] - chosen[0];
    const double dy = y_[slot] - chosen[1];
    const double dz = z_[slot] - chosen[2];
    const double distance_sq = dx * dx + dy * dy + dz * dz;
    changed |= distance_sq < distance_sq_[slot];
    distance_sq_[slot] = std::min(distance_sq_[slot], distance_sq);
  }
  if (!changed) return false;
  leaf.far = {distance_sq_[leaf.begin], leaf.begin};
  leaf.weighted = {weight_[leaf.begin] * distance_sq_[leaf.begin], leaf.begin};
  for (std::uint32_t slot = leaf.begin + 1; slot < leaf.end; ++slot) {
    const Best far = {distance_sq_[slot], slot};
    const Best weighted = {weight_[slot] * distance_sq_[slot], slot};
    if (better(far, leaf.far)) leaf.far = far;
    if (better(weighted, leaf.weighted)) leaf.weighted = weighted;
  }
  return true;
}

}  // namespace shapelight
