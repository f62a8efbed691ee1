#include "simplify/sheets.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/poll.hpp"

namespace shapelight::simplification {
namespace {

// Above this many faces at one edge nobody can tell which belong together: none are paired.
constexpr std::size_t kMaxFacesToPair = 32;

/// Lists by key, each in the order it was filled.
template <class Item>
struct Buckets {
  std::vector<Index> offset;
  std::vector<Item> items;
  [[nodiscard]] std::span<Item> at(std::size_t key) {
    return {items.data() + offset[key], offset[key + 1] - offset[key]};
  }
};

/// Counting sort of item(i), i < count, by key(i) < num_keys.
template <class Item, class Key, class Make>
Buckets<Item> bucket_sort(const RunContext& context, std::size_t num_keys, std::size_t count, Key&& key, Make&& item) {
  Buckets<Item> buckets;
  buckets.offset.assign(num_keys + 2, 0);
  for (std::size_t i = 0; i < count; ++i) {
    poll(context, i);
    ++buckets.offset[key(i) + 2];
  }
  std::partial_sum(buckets.offset.begin(), buckets.offset.end(), buckets.offset.begin());
  buckets.items.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    poll(context, i);
    buckets.items[buckets.offset[key(i) + 1]++] = item(i);
  }
  buckets.offset.pop_back();
  return buckets;
}

/// Half-edge h = 3 face + corner runs from that corner to the next one.
constexpr Index face_of(Index h) { return h / 3; }
constexpr Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }

struct EdgeEnd {
  Index to, half_edge;
  friend auto operator<=>(const EdgeEnd&, const EdgeEnd&) = default;
};

class SheetCutter {
 public:
  SheetCutter(std::span<const Vec3> positions, std::vector<Triangle> triangles, const RunContext& context)
      : context_(context), positions_(positions), triangles_(std::move(triangles)) {}

  Sheets run(MeshOddities& oddities) {
    oddities.duplicate_faces += remove_duplicates();
    twin_.assign(3 * triangles_.size(), kNoIndex);
    junction_.assign(positions_.size(), 0);
    group_edges();
    for_each_edge([&](std::span<const EdgeEnd> ends) { pair_faces(ends); });
    oddities.reoriented_faces += orient();
    find_fans();
    if (cut_repeated_edges()) find_fans();
    return number_fans();
  }

 private:
  [[nodiscard]] Index from(Index h) const { return triangles_[face_of(h)][h % 3]; }
  [[nodiscard]] Index to(Index h) const { return from(next(h)); }

  // Faces over the same three vertices, whatever their direction; the first one stays.
  std::size_t remove_duplicates() {
    using Face = std::array<Index, 3>;  // two larger vertices, face
    const auto smallest = [&](std::size_t f) { return std::ranges::min(triangles_[f]); };
    auto faces = bucket_sort<Face>(context_, positions_.size(), triangles_.size(), smallest, [&](std::size_t f) {
      Triangle t = triangles_[f];
      std::ranges::sort(t);
      return Face{t[1], t[2], static_cast<Index>(f)};
    });
    std::vector<std::uint8_t> duplicate(triangles_.size(), 0);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      poll(context_, v);
      const auto here = faces.at(v);
      std::ranges::sort(here);
      for (std::size_t i = 1; i < here.size(); ++i) {
        duplicate[here[i][2]] = here[i][0] == here[i - 1][0] && here[i][1] == here[i - 1][1];
      }
    }
    const std::size_t before = triangles_.size();
    std::size_t kept = 0;
    for (std::size_t f = 0; f < before; ++f) {
      if (!duplicate[f]) triangles_[kept++] = triangles_[f];
    }
    triangles_.resize(kept);
    return before - kept;
  }

  void group_edges() {
    const auto lower = [&](std::size_t h) { return std::min(from(static_cast<Index>(h)), to(static_cast<Index>(h))); };
    edges_ = bucket_sort<EdgeEnd>(context_, positions_.size(), 3 * triangles_.size(), lower, [&](std::size_t i) {
      const Index h = static_cast<Index>(i);
      return EdgeEnd{std::max(from(h), to(h)), h};
    });
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      poll(context_, v);
      std::ranges::sort(edges_.at(v));
    }
  }

  // body(the half-edges over one pair of vertices), for every edge.
  template <class Body>
  void for_each_edge(Body&& body) {
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      poll(context_, v);
      std::span<const EdgeEnd> rest = edges_.at(v);
      while (!rest.empty()) {
        std::size_t count = 1;
        while (count < rest.size() && rest[count].to == rest[0].to) ++count;
        body(rest.first(count));
        rest = rest.subspan(count);
      }
    }
  }

  void pair(Index a, Index b) {
    twin_[a] = b;
    twin_[b] = a;
  }
  void lock_ends(Index h) { junction_[from(h)] = junction_[to(h)] = 1; }

  // Unit vector in the face, away from the edge and square to it.
  [[nodiscard]] Vec3 wing(Index h) const {
    const Vec3 edge = (positions_[to(h)] - positions_[from(h)]).normalized();
    const Vec3 side = positions_[from(next(next(h)))] - positions_[from(h)];
    return (side - edge.dot(side) * edge).normalized();
  }

  // Faces that run the edge in opposite directions first, then by the flattest angle.
  void pair_faces(std::span<const EdgeEnd> ends) {
    if (ends.size() == 1) return;
    if (ends.size() == 2) return pair(ends[0].half_edge, ends[1].half_edge);
    if (ends.size() <= kMaxFacesToPair) {
      std::vector<Vec3> wings;
      for (const EdgeEnd& end : ends) wings.push_back(wing(end.half_edge));
      std::vector<std::tuple<bool, double, Index, Index>> candidates;
      for (std::size_t i = 0; i < ends.size(); ++i) {
        for (std::size_t j = i + 1; j < ends.size(); ++j) {
          const Index a = ends[i].half_edge, b = ends[j].half_edge;
          const double fold = wings[i].dot(wings[j]);  // -1: flat; NaN on degenerate geometry
          candidates.emplace_back(from(a) == from(b), fold <= 1.0 ? fold : 2.0, a, b);
        }
      }
      std::ranges::sort(candidates);
      for (const auto& [same_direction, fold, a, b] : candidates) {
        if (twin_[a] == kNoIndex && twin_[b] == kNoIndex) pair(a, b);
      }
    }
    for (const EdgeEnd& end : ends) {
      if (twin_[end.half_edge] == kNoIndex) lock_ends(end.half_edge);
    }
  }

  void cut(Index h) {
    lock_ends(h);
    twin_[twin_[h]] = kNoIndex;
    twin_[h] = kNoIndex;
  }

  // Breadth first over paired faces. The majority of a component keeps its orientation; where a component has none
  // (a Moebius strip), the pairs that disagree are cut.
  std::size_t orient() {
    std::vector<std::uint8_t> seen(triangles_.size(), 0), turned(triangles_.size(), 0);
    std::vector<Index> queue;
    std::size_t num_turned = 0;
    for (Index seed = 0; seed < triangles_.size(); ++seed) {
      poll(context_, seed);
      if (seen[seed]) continue;
      queue.assign(1, seed);
      seen[seed] = 1;
      for (std::size_t i = 0; i < queue.size(); ++i) {
        poll(context_, i);
        const Index f = queue[i];
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
          if (twin_[h] == kNoIndex) continue;
          const Index g = face_of(twin_[h]);
          const bool turn = turned[f] ^ (from(h) == from(twin_[h]));
          if (!seen[g]) {
            seen[g] = 1;
            turned[g] = turn;
            queue.push_back(g);
          } else if (turned[g] != turn) {
            cut(h);
          }
        }
      }
      std::size_t minority = 0;
      for (const Index f : queue) minority += turned[f];
      const bool turn_others = 2 * minority > queue.size();
      for (const Index f : queue) turned[f] ^= turn_others;
      num_turned += turn_others ? queue.size() - minority : minority;
    }
    turn_over(turned);
    return num_turned;
  }

  void turn_over(std::span<const std::uint8_t> turned) {
    // Turned over, (a, b, c) is (a, c, b): its first and last half-edges trade places.
    const auto renamed = [&](Index h) { return turned[face_of(h)] && h % 3 != 1 ? h - h % 3 + (2 - h % 3) : h; };
    std::vector<Index> twin(twin_.size());
    for (Index h = 0; h < twin_.size(); ++h) {
      poll(context_, h);
      twin[renamed(h)] = twin_[h] == kNoIndex ? kNoIndex : renamed(twin_[h]);
    }
    twin_.swap(twin);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      poll(context_, v);
      for (EdgeEnd& end : edges_.at(v)) end.half_edge = renamed(end.half_edge);
    }
    for (std::size_t f = 0; f < triangles_.size(); ++f) {
      if (turned[f]) std::swap(triangles_[f][1], triangles_[f][2]);
    }
  }

  // Corners (numbered like the half-edges that leave them) joined across paired edges.
  void find_fans() {
    fan_.resize(twin_.size());
    std::iota(fan_.begin(), fan_.end(), Index{0});
    for (Index h = 0; h < twin_.size(); ++h) {
      poll(context_, h);
      if (twin_[h] == kNoIndex || twin_[h] < h) continue;
      join(h, next(twin_[h]));
      join(next(h), twin_[h]);
    }
  }
  Index fan(Index corner) {
    while (fan_[corner] != corner) corner = fan_[corner] = fan_[fan_[corner]];
    return corner;
  }
  void join(Index a, Index b) {
    a = fan(a);
    b = fan(b);
    fan_[std::max(a, b)] = std::min(a, b);
  }

  // Two fans may meet in two edges with the same ends: two pairs over one edge. Cut open they become different copies.
  bool cut_repeated_edges() {
    bool found = false;
    for_each_edge([&](std::span<const EdgeEnd> ends) {
      if (ends.size() < 3 || ends.size() > kMaxFacesToPair || !is_repeated(ends)) return;
      found = true;
      for (const EdgeEnd& end : ends) {
        if (twin_[end.half_edge] != kNoIndex) cut(end.half_edge);
      }
    });
    return found;
  }
  bool is_repeated(std::span<const EdgeEnd> ends) {
    const auto fans_of = [&](Index h) {
      const Index a = fan(h), b = fan(next(h));
      return from(h) < to(h) ? std::pair(a, b) : std::pair(b, a);
    };
    for (std::size_t i = 0; i < ends.size(); ++i) {
      for (std::size_t j = i + 1; j < ends.size(); ++j) {
        const Index a = ends[i].half_edge, b = ends[j].half_edge;
        if (twin_[a] != b && fans_of(a) == fans_of(b)) return true;
      }
    }
    return false;
  }

  Sheets number_fans() {
    Sheets sheets;
    const auto vertex = [&](std::size_t corner) { return from(static_cast<Index>(corner)); };
    auto corners = bucket_sort<Index>(context_, positions_.size(), fan_.size(), vertex,
                                      [](std::size_t corner) { return static_cast<Index>(corner); });
    std::vector<Index> number(fan_.size(), kNoIndex);
    sheets.triangles = triangles_;
    for (Index v = 0; v < positions_.size(); ++v) {
      poll(context_, v);
      for (const Index corner : corners.at(v)) {
        Index& copy = number[fan(corner)];
        if (copy == kNoIndex) {
          copy = static_cast<Index>(sheets.source.size());
          sheets.source.push_back(v);
          sheets.locked.push_back(junction_[v]);
        }
        sheets.triangles[face_of(corner)][corner % 3] = copy;
      }
    }
    return sheets;
  }

  const RunContext& context_;
  std::span<const Vec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<Index> twin_;             // per half-edge: the one it is paired with
  std::vector<std::uint8_t> junction_;  // per input vertex
  Buckets<EdgeEnd> edges_;              // by the lower vertex, sorted by the other one
  std::vector<Index> fan_;              // per corner: union-find
};

}  // namespace

Sheets cut_into_sheets(std::span<const Vec3> positions, std::vector<Triangle> triangles, MeshOddities& oddities,
                       const RunContext& context) {
  return SheetCutter(positions, std::move(triangles), context).run(oddities);
}

}  // namespace shapelight::simplification
