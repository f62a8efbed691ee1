#include "shapelight/spatial/kd_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace shapelight {
namespace {

constexpr std::uint32_t kLeafSize = 12;
constexpr std::uint32_t kPollSize = 4096;  // smaller subtrees are built without a look at the stop token
constexpr std::size_t kQueryChunk = 1024;  // leaves are walked in order, so a chunk of slots stays in the cache
using Point = std::array<double, 3>;

Point to_array(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

double box_distance_sq(const Point& min, const Point& max, const Point& query) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double outside = std::max({min[axis] - query[axis], 0.0, query[axis] - max[axis]});
    sum += outside * outside;
  }
  return sum;
}

}  // namespace

// The best `capacity` neighbours so far, kept sorted: at the sizes in use, shifting beats a heap.
class KdTree::Candidates {
 public:
  Candidates(std::size_t capacity, std::vector<Neighbor>& storage) : storage_(storage), capacity_(capacity) {
    storage_.resize(capacity);
    best_ = storage_.data();
  }
  ~Candidates() { storage_.resize(count_); }
  Candidates(const Candidates&) = delete;
  Candidates& operator=(const Candidates&) = delete;

  /// None farther than this; before the first offer.
  void limit(double distance_sq) { worst_ = distance_sq; }
  [[nodiscard]] double worst() const { return worst_; }
  void offer(const Neighbor& found) {
    std::size_t place = count_;
    if (count_ == capacity_) {
      if (!(found < best_[count_ - 1])) return;
      --place;  // the last one falls out
    } else {
      ++count_;
    }
    for (; place > 0 && found < best_[place - 1]; --place) best_[place] = best_[place - 1];
    best_[place] = found;
    if (count_ == capacity_) worst_ = best_[count_ - 1].distance_sq;
  }
  [[nodiscard]] std::span<const Neighbor> found() const { return {best_, count_}; }

 private:
  std::vector<Neighbor>& storage_;
  Neighbor* best_ = nullptr;
  std::size_t count_ = 0;
  std::size_t capacity_;
  double worst_ = std::numeric_limits<double>::infinity();
};

KdTree::KdTree(std::span<const Vec3> points, const RunContext& context) : index_(points.size()) {
  for (std::size_t i = 0; i < points.size(); ++i) index_[i] = static_cast<Index>(i);
  if (!points.empty()) {
    nodes_.reserve(2 * points.size() / (kLeafSize / 2) + 2);
    build(0, static_cast<std::uint32_t>(points.size()), 0, points, context);
  }
  x_.resize(points.size());
  y_.resize(points.size());
  z_.resize(points.size());
  for (std::size_t slot = 0; slot < points.size(); ++slot) {
    const Vec3& p = points[index_[slot]];
    x_[slot] = p.x();
    y_[slot] = p.y();
    z_[slot] = p.z();
  }
}

std::uint32_t KdTree::build(std::uint32_t begin, std::uint32_t end, std::uint32_t parent, std::span<const Vec3> points,
                            const RunContext& context) {
  if (end - begin > kPollSize) context.check();
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  Vec3 min = points[index_[begin]];
  Vec3 max = min;
  for (std::uint32_t slot = begin + 1; slot < end; ++slot) {
    min = min.cwiseMin(points[index_[slot]]);
    max = max.cwiseMax(points[index_[slot]]);
  }
  nodes_.push_back({to_array(min), to_array(max), begin, end, 0, parent});
  if (end - begin <= kLeafSize) return id;

  int axis = 0;
  (max - min).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(index_.begin() + begin, index_.begin() + middle, index_.begin() + end, [&](Index a, Index b) {
    const double ca = points[a][axis];
    const double cb = points[b][axis];
    return ca < cb || (ca == cb && a < b);
  });
  build(begin, middle, id, points, context);
  const std::uint32_t right = build(middle, end, id, points, context);
  nodes_[id].right = right;
  return id;
}

void KdTree::scan(const Node& leaf, const Point& query, Candidates& found) const {
  for (std::uint32_t slot = leaf.begin; slot < leaf.end; ++slot) {
    const double dx = x_[slot] - query[0];
    const double dy = y_[slot] - query[1];
    const double dz = z_[slot] - query[2];
    const double distance_sq = dx * dx + dy * dy + dz * dz;
    if (distance_sq <= found.worst()) found.offer({distance_sq, index_[slot]});
  }
}

void KdTree::search(std::uint32_t node, const Point& query, Candidates& found) const {
  const Node& here = nodes_[node];
  if (here.right == 0) return scan(here, query, found);
  std::uint32_t near = node + 1;
  std::uint32_t far = here.right;
  double near_sq = box_distance_sq(nodes_[near].min, nodes_[near].max, query);
  double far_sq = box_distance_sq(nodes_[far].min, nodes_[far].max, query);
  if (far_sq < near_sq) {
    std::swap(near, far);
    std::swap(near_sq, far_sq);
  }
  // "<=": a point at the same distance may have the lower index.
  if (near_sq <= found.worst()) search(near, query, found);
  if (far_sq <= found.worst()) search(far, query, found);
}

void KdTree::nearest(const Vec3& query, std::size_t k, std::vector<Neighbor>& found, double limit_sq) const {
  Candidates candidates(std::min(k, size()), found);
  candidates.limit(limit_sq);
  if (k > 0 && !nodes_.empty()) search(0, to_array(query), candidates);
}

Neighbor KdTree::nearest(const Vec3& query) const {
  std::vector<Neighbor> found;
  nearest(query, 1, found);
  return found.empty() ? Neighbor{} : found.front();
}

void KdTree::within(const Vec3& query, double radius, std::vector<Neighbor>& found) const {
  found.clear();
  const Point center = to_array(query);
  const double limit = radius * radius;
  std::vector<std::uint32_t> open;
  if (!nodes_.empty()) open.push_back(0);
  while (!open.empty()) {
    const std::uint32_t id = open.back();
    const Node& node = nodes_[id];
    open.pop_back();
    if (box_distance_sq(node.min, node.max, center) > limit) continue;
    if (node.right != 0) {
      open.push_back(id + 1);
      open.push_back(node.right);
      continue;
    }
    for (std::uint32_t slot = node.begin; slot < node.end; ++slot) {
      const double distance_sq = (Vec3(x_[slot], y_[slot], z_[slot]) - query).squaredNorm();
      if (distance_sq <= limit) found.push_back({distance_sq, index_[slot]});
    }
  }
  std::sort(found.begin(), found.end());
}

std::vector<Index> KdTree::all_nearest(std::size_t k, const RunContext& context) const {
  std::vector<Index> table(size() * k, kNoIndex);
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t id = 0; id < nodes_.size(); ++id) {
    if (nodes_[id].right == 0) leaves.push_back(id);
  }
  const auto query_leaf = [&](std::uint32_t leaf, std::vector<Neighbor>& found) {
    for (std::uint32_t slot = nodes_[leaf].begin; slot < nodes_[leaf].end; ++slot) {
      const Point query = {x_[slot], y_[slot], z_[slot]};
      Candidates candidates(std::min(k + 1, size()), found);  // one more: the point itself is found too
      scan(nodes_[leaf], query, candidates);
      // Climb to the root; at each step only the sibling is new.
      for (std::uint32_t child = leaf; child != 0; child = nodes_[child].parent) {
        const std::uint32_t parent = nodes_[child].parent;
        const std::uint32_t sibling = child == parent + 1 ? nodes_[parent].right : parent + 1;
        if (box_distance_sq(nodes_[sibling].min, nodes_[sibling].max, query) <= candidates.worst()) {
          search(sibling, query, candidates);
        }
      }
      std::size_t written = 0;
      for (const Neighbor& neighbor : candidates.found()) {
        if (neighbor.index != index_[slot] && written < k) table[index_[slot] * k + written++] = neighbor.index;
      }
    }
  };
  parallel::for_chunks(
      context, leaves.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<Neighbor> found;
        for (std::size_t i = begin; i < end; ++i) query_leaf(leaves[i], found);
      },
      kQueryChunk / kLeafSize);
  return table;
}

}  // namespace shapelight
