#include "simplify/wedges.hpp"

#include <algorithm>
#include <utility>

#include "core/poll.hpp"

namespace shapelight::simplification {
namespace {

// Fans above this size are sorted before they are walked.
constexpr std::size_t kLargeFan = 48;

// Walks from the first wedge; every step must find exactly one follower. Returns the number of wedges in order.
std::size_t walk(std::span<Wedge> wedges, bool& ambiguous) {
  for (std::size_t i = 1; i < wedges.size(); ++i) {
    const Index at = wedges[i - 1].previous;
    std::size_t found = wedges.size();
    for (std::size_t j = i; j < wedges.size(); ++j) {
      if (wedges[j].next != at) continue;
      ambiguous |= found != wedges.size();
      found = j;
    }
    if (found == wedges.size()) return i;
    std::swap(wedges[i], wedges[found]);
  }
  return wedges.size();
}

// The wedge that no other one leads to; wedges.size() when there is none.
std::size_t find_start(std::span<const Wedge> wedges) {
  for (std::size_t i = 0; i < wedges.size(); ++i) {
    const auto leads_here = [&](const Wedge& w) { return w.previous == wedges[i].next; };
    if (std::none_of(wedges.begin(), wedges.end(), leads_here)) return i;
  }
  return wedges.size();
}

Fan order_small_fan(std::span<Wedge> wedges) {
  bool ambiguous = false;
  if (walk(wedges, ambiguous) < wedges.size()) {
    const std::size_t start = find_start(wedges);
    if (start == wedges.size()) return Fan::Irregular;
    std::swap(wedges[0], wedges[start]);
    if (walk(wedges, ambiguous) < wedges.size()) return Fan::Irregular;
  }
  // All are chained. Neighbours are distinct when the walk was never ambiguous and never came back early.
  const Index last = wedges.back().previous;
  for (std::size_t i = 1; i < wedges.size(); ++i) {
    ambiguous |= wedges[i].next == wedges[0].next || wedges[i].next == last;
  }
  const bool closed = last == wedges[0].next;
  if (ambiguous || (closed && wedges.size() < 3)) return Fan::Irregular;  // two faces back to back are no fan
  return closed ? Fan::Closed : Fan::Open;
}

Fan order_large_fan(std::span<Wedge> wedges) {
  const auto by_next = [](const Wedge& a, const Wedge& b) { return a.next < b.next; };
  const Wedge first = wedges[0];
  std::vector<Wedge> sorted(wedges.begin(), wedges.end());
  std::sort(sorted.begin(), sorted.end(), by_next);
  std::vector<Index> previous(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) previous[i] = sorted[i].previous;
  std::sort(previous.begin(), previous.end());
  const auto same_next = [](const Wedge& a, const Wedge& b) { return a.next == b.next; };
  if (std::adjacent_find(sorted.begin(), sorted.end(), same_next) != sorted.end() ||
      std::adjacent_find(previous.begin(), previous.end()) != previous.end()) {
    return Fan::Irregular;
  }
  const auto is_start = [&](const Wedge& w) { return !std::binary_search(previous.begin(), previous.end(), w.next); };
  const auto start = std::find_if(sorted.begin(), sorted.end(), is_start);
  wedges[0] = start == sorted.end() ? first : *start;
  for (std::size_t i = 1; i < wedges.size(); ++i) {
    const Wedge at{wedges[i - 1].previous, 0};
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), at, by_next);
    if (found == sorted.end() || found->next != at.next || found->next == wedges[0].next) return Fan::Irregular;
    wedges[i] = *found;
  }
  return wedges.back().previous == wedges[0].next ? Fan::Closed : Fan::Open;
}

}  // namespace

Wedges collect_wedges(std::size_t num_vertices, std::span<const Triangle> triangles, const RunContext& context) {
  Wedges wedges;
  // Counts two places ahead: after the running sum, offset[v + 1] is where the next wedge of v goes.
  wedges.offset.assign(num_vertices + 2, 0);
  Index* const offset = wedges.offset.data();
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    poll(context, f);
    const Triangle& t = triangles[f];
    ++offset[t[0] + 2];
    ++offset[t[1] + 2];
    ++offset[t[2] + 2];
  }
  for (std::size_t v = 0; v < num_vertices; ++v) offset[v + 2] += offset[v + 1];
  wedges.items.resize(3 * triangles.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    poll(context, f);
    const Triangle& t = triangles[f];
    wedges.items[offset[t[0] + 1]++] = {t[1], t[2]};
    wedges.items[offset[t[1] + 1]++] = {t[2], t[0]};
    wedges.items[offset[t[2] + 1]++] = {t[0], t[1]};
  }
  wedges.offset.pop_back();
  return wedges;
}

Fan order_fan(std::span<Wedge> wedges) {
  if (wedges.empty()) return Fan::Irregular;
  return wedges.size() <= kLargeFan ? order_small_fan(wedges) : order_large_fan(wedges);
}

}  // namespace shapelight::simplification
