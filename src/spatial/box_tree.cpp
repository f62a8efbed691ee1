#include "spatial/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"

namespace shapelight {
namespace {

constexpr std::uint32_t kBins = 16;
constexpr std::size_t kHalvedDepth = BoxTree::kMaxDepth / 2;  // from here on groups are halved by count
constexpr std::uint32_t kTaskSize = 8192;                     // smaller groups are built by one thread each
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Box kEmptyBox = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

// An item on its way to its place.
struct Entry {
  Box box;
  Index item;

  // Twice the centre: only comparisons are made with it.
  [[nodiscard]] float center(std::size_t axis) const { return box.min[axis] + box.max[axis]; }
};

// Consecutive entries that become one child.
struct Group {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  Box box = kEmptyBox;
  [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

void grow(Box& box, const Box& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::min(box.min[axis], other.min[axis]);
    box.max[axis] = std::max(box.max[axis], other.max[axis]);
  }
}

float half_area(const Box& box) {
  const float x = box.max[0] - box.min[0], y = box.max[1] - box.min[1], z = box.max[2] - box.min[2];
  return x * y + y * z + z * x;
}

class Builder {
 public:
  Builder(std::span<const Box> boxes, const RunContext& context);
  BoxTree build();

 private:
  // A child that another thread builds: its group, and where its node's index belongs.
  struct Task {
    Group group;
    std::size_t depth, node, slot;
    std::vector<BoxNode> nodes;
  };

  [[nodiscard]] Group group_of(std::uint32_t begin, std::uint32_t end) const;
  std::uint32_t partition(const Group& group, std::size_t depth);
  std::uint32_t add_node(std::vector<BoxNode>& nodes, const Group& group, std::size_t depth, std::vector<Task>* tasks);

  const RunContext& context_;
  std::vector<Entry> entries_;
};

Builder::Builder(std::span<const Box> boxes, const RunContext& context) : context_(context), entries_(boxes.size()) {
  for (std::size_t i = 0; i < boxes.size(); ++i) entries_[i] = {boxes[i], static_cast<Index>(i)};
}

Group Builder::group_of(std::uint32_t begin, std::uint32_t end) const {
  Group group{begin, end, kEmptyBox};
  for (std::uint32_t i = begin; i < end; ++i) grow(group.box, entries_[i].box);
  return group;
}

struct Bin {
  Box box = kEmptyBox;
  std::uint32_t count = 0;
};

// The number of bins that go to the left: the least sum of (area x count) over both sides.
std::uint32_t best_cut(const std::array<Bin, kBins>& bins) {
  std::array<float, kBins> right_cost{};
  Bin side;
  for (std::uint32_t k = kBins - 1; k > 0; --k) {
    grow(side.box, bins[k].box);
    side.count += bins[k].count;
    right_cost[k] = side.count > 0 ? half_area(side.box) * static_cast<float>(side.count) : kInfinity;
  }
  side = {};
  std::uint32_t best = 0;
  float best_cost = kInfinity;
  for (std::uint32_t k = 1; k < kBins; ++k) {
    grow(side.box, bins[k - 1].box);
    side.count += bins[k - 1].count;
    const float cost =
        side.count > 0 ? half_area(side.box) * static_cast<float>(side.count) + right_cost[k] : kInfinity;
    if (cost < best_cost) {
      best_cost = cost;
      best = k;
    }
  }
  return best;
}

// Moves the left part of a group to its front and returns where the right one begins; both are non-empty.
std::uint32_t Builder::partition(const Group& group, std::size_t depth) {
  const auto first = entries_.begin() + group.begin, last = entries_.begin() + group.end;
  std::array<float, 3> low, high;
  low.fill(kInfinity);
  high.fill(-kInfinity);
  for (auto entry = first; entry != last; ++entry) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], entry->center(axis));
      high[axis] = std::max(high[axis], entry->center(axis));
    }
  }
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other) {
    if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
  }
  const float per_length = static_cast<float>(kBins) / (high[axis] - low[axis]);
  if (depth < kHalvedDepth && std::isfinite(per_length)) {
    const auto bin_of = [&](const Entry& entry) {
      return std::min(kBins - 1, static_cast<std::uint32_t>((entry.center(axis) - low[axis]) * per_length));
    };
    std::array<Bin, kBins> bins;
    for (auto entry = first; entry != last; ++entry) {
      Bin& bin = bins[bin_of(*entry)];
      grow(bin.box, entry->box);
      ++bin.count;
    }
    if (const std::uint32_t cut = best_cut(bins); cut > 0) {
      const auto middle = std::partition(first, last, [&](const Entry& entry) { return bin_of(entry) < cut; });
      return static_cast<std::uint32_t>(middle - entries_.begin());
    }
  }
  const auto middle = first + (last - first) / 2;
  std::nth_element(first, middle, last, [&](const Entry& a, const Entry& b) {
    return a.center(axis) < b.center(axis) || (a.center(axis) == b.center(axis) && a.item < b.item);
  });
  return static_cast<std::uint32_t>(middle - entries_.begin());
}

// Adds the node of a group and those below it; large children are left to `tasks` when given.
std::uint32_t Builder::add_node(std::vector<BoxNode>& nodes, const Group& group, std::size_t depth,
                                std::vector<Task>* tasks) {
  std::array<Group, BoxNode::kWidth> child{group};
  std::size_t count = 1;
  while (count < BoxNode::kWidth) {
    Group* widest = nullptr;
    for (std::size_t k = 0; k < count; ++k) {
      if (child[k].size() > 1 && (!widest || half_area(child[k].box) > half_area(widest->box))) widest = &child[k];
    }
    if (!widest) break;
    if (tasks) context_.check();
    const std::uint32_t middle = partition(*widest, depth);
    child[count++] = group_of(middle, widest->end);
    *widest = group_of(widest->begin, middle);
  }
  const std::size_t at = nodes.size();
  nodes.emplace_back();
  for (std::size_t k = 0; k < BoxNode::kWidth; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      nodes[at].min[axis][k] = k < count ? child[k].box.min[axis] : std::numeric_limits<float>::quiet_NaN();
      nodes[at].max[axis][k] = k < count ? child[k].box.max[axis] : std::numeric_limits<float>::quiet_NaN();
    }
    nodes[at].child[k] = BoxNode::kItem | child[k].begin;
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (child[k].size() == 1) continue;
    if (tasks && child[k].size() <= kTaskSize) {
      tasks->push_back({child[k], depth + 1, at, k, {}});
    } else {
      const std::uint32_t below = add_node(nodes, child[k], depth + 1, tasks);
      nodes[at].child[k] = below;
    }
  }
  return static_cast<std::uint32_t>(at);
}

BoxTree Builder::build() {
  BoxTree tree;
  std::vector<Task> tasks;
  add_node(tree.nodes, group_of(0, static_cast<std::uint32_t>(entries_.size())), 0, &tasks);
  parallel::for_chunks(
      context_, tasks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          tasks[i].nodes.reserve(tasks[i].group.size() / 2);
          add_node(tasks[i].nodes, tasks[i].group, tasks[i].depth, nullptr);
        }
      },
      1);
  std::size_t num_nodes = tree.nodes.size();
  for (const Task& task : tasks) num_nodes += task.nodes.size();
  tree.nodes.reserve(num_nodes);
  for (const Task& task : tasks) {
    context_.check();
    const auto base = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes[task.node].child[task.slot] = base;
    for (BoxNode node : task.nodes) {
      for (std::uint32_t& child : node.child) {
        if (!(child & BoxNode::kItem)) child += base;
      }
      tree.nodes.push_back(node);
    }
  }
  context_.check();
  tree.order.resize(entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i) tree.order[i] = entries_[i].item;
  return tree;
}

}  // namespace

BoxTree build_box_tree(std::span<const Box> boxes, const RunContext& context) {
  return Builder(boxes, context).build();
}

}  // namespace shapelight
