#include "shapelight/spatial/triangle_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "shapelight/core/error.hpp"
#include "spatial/triangle_tree_impl.hpp"

namespace shapelight {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The nearest floats on either side; float -> double is exact, so comparing finds out which way the cast went.
float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) <= x ? f : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float round_up(double x) { return -round_down(-x); }

// The foot of the perpendicular, by modified Gram-Schmidt on the longer edge: unlike the barycentric quotients, this
// stays accurate on slivers.
Vec3 foot_in_triangle(const Vec3& query, const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 base = b - a, side = c - a;
  if (base.squaredNorm() < side.squaredNorm()) std::swap(base, side);
  const double base_sq = base.squaredNorm();
  const Vec3 height = side - side.dot(base) / base_sq * base;
  const double height_sq = height.squaredNorm();
  const Vec3 aq = query - a;
  const Vec3 along = aq.dot(base) / base_sq * base;
  if (!(height_sq > 0.0)) return a + along;  // flat to the last digit
  return a + along + (aq - along).dot(height) / height_sq * height;
}

}  // namespace

Vec3 closest_point_on_triangle(const Vec3& query, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, aq = query - a;
  const double d1 = ab.dot(aq), d2 = ac.dot(aq);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vec3 bq = query - b;
  const double d3 = ab.dot(bq), d4 = ac.dot(bq);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const Vec3 cq = query - c;
  const double d5 = ab.dot(cq), d6 = ac.dot(cq);
  if (d6 >= 0.0 && d5 <= d6) return c;
  // Outside of an edge, by cross products: quotients of the products above would misjudge slivers. Strict comparisons
  // keep edges of no length out.
  const Vec3 normal = ab.cross(ac);
  if (d1 > 0.0 && d3 < 0.0 && ab.cross(aq).dot(normal) <= 0.0) return a + d1 / (d1 - d3) * ab;
  if (d2 > 0.0 && d6 < 0.0 && aq.cross(ac).dot(normal) <= 0.0) return a + d2 / (d2 - d6) * ac;
  const double toward_c = d4 - d3, toward_b = d5 - d6;
  const Vec3 bc = c - b;
  if (toward_c > 0.0 && toward_b > 0.0 && bc.cross(bq).dot(normal) <= 0.0) {
    return b + toward_c / (toward_c + toward_b) * bc;
  }
  return foot_in_triangle(query, a, b, c);
}

// The closest point so far.
struct TriangleTree::Impl::Best {
  double distance_sq = kInfinity;
  float bound = std::numeric_limits<float>::infinity();  // boxes farther than this hold nothing better
  Index triangle = kNoIndex;
  Vec3 point = Vec3::Zero();

  void offer(const Corners& corners, const Vec3& query) {
    const Vec3 found = closest_point_on_triangle(query, corners.a, corners.b, corners.c);
    const double found_sq = (found - query).squaredNorm();
    if (!(found_sq <= distance_sq) || (found_sq == distance_sq && corners.triangle > triangle)) return;
    distance_sq = found_sq;
    bound = round_up(found_sq * (1.0 + 1e-6));  // more than the roundings of box_distances()
    triangle = corners.triangle;
    point = found;
  }
};

namespace {

// A query as floats, rounded down and up.
struct QueryBox {
  std::array<float, 3> low, high;
  explicit QueryBox(const Vec3& query) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = round_down(query[axis]);
      high[axis] = round_up(query[axis]);
    }
  }
};

// Squared distances to the boxes of a node, never too long but for the few roundings here.
Float4 box_distances(const BoxNode& node, const QueryBox& query) {
  Float4 distance_sq{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Float4 below = node.min[axis] - query.high[axis], above = query.low[axis] - node.max[axis];
    const Float4 outside = below > above ? below : above;
    const Float4 distance = Float4{} > outside ? Float4{} : outside;  // in this order NaN gets through: an unused place
    distance_sq += distance * distance;
  }
  return distance_sq;
}

}  // namespace

TriangleTree::Impl::Impl(const TriangleMesh& mesh, const RunContext& context) {
  const std::size_t count = mesh.triangles.size();
  if (count == 0 || count >= BoxNode::kItem) {
    throw InvalidInput(fmt::format("triangle tree: {} triangles, expected 1 to {}", count, BoxNode::kItem - 1));
  }
  choose_frame(mesh);
  std::vector<Box> boxes(count);
  parallel::for_chunks(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Vec3 a = to_local(mesh.positions[mesh.triangles[t][0]]), b = to_local(mesh.positions[mesh.triangles[t][1]]),
                 c = to_local(mesh.positions[mesh.triangles[t][2]]);
      for (int axis = 0; axis < 3; ++axis) {
        boxes[t].min[axis] = round_down(std::min({a[axis], b[axis], c[axis]}));
        boxes[t].max[axis] = round_up(std::max({a[axis], b[axis], c[axis]}));
      }
    }
  });
  tree = build_box_tree(boxes, context);
  corners.resize(count);
  place.resize(count);
  parallel::for_chunks(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index t = tree.order[i];
      const Triangle& triangle = mesh.triangles[t];
      corners[i] = {to_local(mesh.positions[triangle[0]]), to_local(mesh.positions[triangle[1]]),
                    to_local(mesh.positions[triangle[2]]), t};
      place[t] = static_cast<Index>(i);
    }
  });
}

void TriangleTree::Impl::choose_frame(const TriangleMesh& mesh) {
  Vec3 min = Vec3::Constant(kInfinity), max = -min;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) {
      if (v >= mesh.positions.size()) {
        throw InvalidInput(
            fmt::format("triangle tree: triangle {} names vertex {}, expected below {}", t, v, mesh.positions.size()));
      }
      const Vec3& p = mesh.positions[v];
      if (!p.allFinite()) {
        throw InvalidInput(fmt::format("triangle tree: vertex {} of triangle {} is not finite", v, t));
      }
      min = min.cwiseMin(p);
      max = max.cwiseMax(p);
    }
  }
  center = 0.5 * min + 0.5 * max;
  const double half_width = (0.5 * max - 0.5 * min).maxCoeff();
  if (half_width > 0.0) scale = std::ldexp(1.0, std::clamp(-std::ilogb(half_width) - 1, -1000, 1000));
}

TriangleTree::Hit TriangleTree::Impl::closest(const Vec3& query, Index hint) const {
  const Vec3 local = to_local(query);
  Best best;
  if (hint < place.size()) best.offer(corners[place[hint]], local);
  search(local, best);
  if (best.triangle == kNoIndex) return {kNoIndex, query, std::numeric_limits<double>::quiet_NaN()};
  return {best.triangle, center + best.point / scale, best.distance_sq / scale / scale};
}

void TriangleTree::Impl::search(const Vec3& query, Best& best) const {
  struct Open {
    float distance_sq;
    std::uint32_t child;
  };
  const QueryBox query_box(query);
  std::array<Open, BoxTree::kMaxOpen> open;
  std::size_t count = 0;
  std::uint32_t next = 0;  // the root
  while (true) {
    if (next & BoxNode::kItem) {
      best.offer(corners[next & ~BoxNode::kItem], query);
    } else {
      const BoxNode& node = tree.nodes[next];
      const Float4 distance_sq = box_distances(node, query_box);
      const std::size_t first = count;
      for (std::size_t k = 0; k < BoxNode::kWidth; ++k) {
        if (!(distance_sq[k] <= best.bound)) continue;
        const std::uint32_t child = node.child[k];
        prefetch(child);
        std::size_t at = count++;
        for (; at > first && open[at - 1].distance_sq < distance_sq[k]; --at) open[at] = open[at - 1];
        open[at] = {distance_sq[k], child};  // the nearest on top
      }
    }
    do {
      if (count == 0) return;
      --count;
    } while (!(open[count].distance_sq <= best.bound));
    next = open[count].child;
  }
}

TriangleTree::TriangleTree() = default;
TriangleTree::TriangleTree(const TriangleMesh& mesh, const RunContext& context)
    : impl_(std::make_unique<Impl>(mesh, context)) {}
TriangleTree::~TriangleTree() = default;
TriangleTree::TriangleTree(TriangleTree&&) noexcept = default;
TriangleTree& TriangleTree::operator=(TriangleTree&&) noexcept = default;

std::size_t TriangleTree::size() const { return impl_ ? impl_->corners.size() : 0; }

TriangleTree::Hit TriangleTree::closest(const Vec3& query, Index hint) const {
  if (!impl_) throw InvalidInput("triangle tree: is empty, expected one made from a mesh");
  return impl_->closest(query, hint);
}

std::vector<TriangleTree::Hit> TriangleTree::closest(std::span<const Vec3> queries, const RunContext& context) const {
  std::vector<Hit> hits(queries.size());
  parallel::for_chunks(context, queries.size(), [&](std::size_t begin, std::size_t end) {
    Index near = kNoIndex;  // queries that follow each other are often close
    for (std::size_t i = begin; i < end; ++i) {
      hits[i] = closest(queries[i], near);
      near = hits[i].triangle;
    }
  });
  return hits;
}

}  // namespace shapelight
