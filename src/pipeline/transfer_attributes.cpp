#include "pipeline/transfer_attributes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight::pipeline {
namespace {

using Weights = std::array<double, 3>;  // of a triangle's corners, not negative, sum 1
using TexCoord = std::array<float, 2>;

std::array<Vec3, 3> corners_of(const TriangleMesh& mesh, std::size_t face) {
  const Triangle& t = mesh.triangles[face];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

// Barycentric coordinates of a point on the triangle; exactly (1, 0, 0) at a corner.
Weights weights_at(const Vec3& point, const std::array<Vec3, 3>& corner) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (point != corner[k]) continue;
    Weights weights{};
    weights[k] = 1.0;
    return weights;
  }
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  Weights weights{};
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = corner[(k + 1) % 3], &b = corner[(k + 2) % 3];
    weights[k] = std::max(0.0, (a - point).cross(b - point).dot(normal));
    sum += weights[k];
  }
  if (!(sum > 0.0)) {  // no area: between the two ends of its longest edge at best, and any corner will do
    const auto distance = [&](std::size_t k) { return (corner[k] - point).squaredNorm(); };
    const std::size_t nearest =
        distance(0) <= distance(1) ? (distance(0) <= distance(2) ? 0 : 2) : (distance(1) <= distance(2) ? 1 : 2);
    return Weights{nearest == 0 ? 1.0 : 0.0, nearest == 1 ? 1.0 : 0.0, nearest == 2 ? 1.0 : 0.0};
  }
  for (double& w : weights) w /= sum;
  return weights;
}

// Where on the input surface the value of an output vertex is taken.
struct Place {
  Triangle corners{};
  Weights weights{};
  [[nodiscard]] Index nearest_corner() const {
    return corners[static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin())];
  }
};

// Values that must not be mixed: names of classes and identities.
bool is_label(const Column& column) {
  if (column.type() == ScalarType::Int64 || column.type() == ScalarType::UInt64) return true;
  if (column.type() == ScalarType::Float32 || column.type() == ScalarType::Float64) return false;
  for (const std::string_view part : {"label", "class", "segment", "index", "flag", "material", "return", "source"}) {
    if (column.name.find(part) != std::string::npos) return true;
  }
  return column.name == "id" || column.name.ends_with("_id") || column.name.starts_with("id_");
}

template <class T>
std::vector<T> interpolate(const std::vector<T>& values, std::span<const Place> places, const RunContext& context) {
  std::vector<T> result(places.size());
  parallel::for_chunks(context, places.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double value = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (places[i].weights[k] > 0.0)
          value += places[i].weights[k] * static_cast<double>(values[places[i].corners[k]]);
      }
      if constexpr (std::is_integral_v<T>) value = std::round(value);
      result[i] = static_cast<T>(value);
    }
  });
  return result;
}

void make_unit(AttributeTable& table) {
  std::array<Column*, 3> normal = {table.find("nx"), table.find("ny"), table.find("nz")};
  for (const Column* column : normal) {
    if (column == nullptr) return;
  }
  for (std::size_t i = 0; i < normal[0]->size(); ++i) {
    const Vec3 n(normal[0]->as_double(i), normal[1]->as_double(i), normal[2]->as_double(i));
    const double length = n.norm();
    if (!(length > 0.0)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const auto set = [&]<class T>(std::vector<T>& values) {
        if constexpr (std::is_floating_point_v<T>) values[i] = static_cast<T>(n[axis] / length);
      };
      std::visit(set, normal[static_cast<std::size_t>(axis)]->values);
    }
  }
}

AttributeTable interpolate_table(const AttributeTable& table, std::span<const Place> places,
                                 const RunContext& context) {
  std::vector<Index> nearest(places.size());
  std::transform(places.begin(), places.end(), nearest.begin(), [](const Place& p) { return p.nearest_corner(); });
  AttributeTable result;
  for (const Column& column : table.columns()) {
    context.check();
    if (is_label(column)) {
      result.set(column.gather(nearest));
    } else {
      result.set({column.name,
                  std::visit([&](const auto& values) { return Column::Values(interpolate(values, places, context)); },
                             column.values)});
    }
  }
  make_unit(result);
  return result;
}

std::vector<Place> places_on(const TriangleTree& tree, const TriangleMesh& surface, std::span<const Vec3> points,
                             const RunContext& context) {
  const std::vector<TriangleTree::Hit> hits = tree.closest(points, context);
  std::vector<Place> places(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    poll(context, i);
    places[i] = {surface.triangles[hits[i].triangle], weights_at(hits[i].point, corners_of(surface, hits[i].triangle))};
  }
  return places;
}

Index input_triangle(const Surface& surface, Index face) {
  return surface.triangle_of.empty() ? face : surface.triangle_of[face];
}

// The picture's own neighbourhood: faces across edges on which their texture coordinates agree.
struct Atlas {
  std::vector<std::array<Index, 3>> neighbors;  // per face; kNoIndex at seams and borders
  FeatureEdges seams;

  Atlas(const Geometry& geometry, const Surface& surface, const RunContext& context);

 private:
  void connect(Index face, Index neighbor) {
    *std::find(neighbors[face].begin(), neighbors[face].end(), kNoIndex) = neighbor;
  }
};

Atlas::Atlas(const Geometry& geometry, const Surface& surface, const RunContext& context) {
  struct Side {
    Index low, high, face;
    TexCoord at_low, at_high;
  };
  const std::vector<Triangle>& triangles = surface.mesh.triangles;
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  neighbors.assign(triangles.size(), {kNoIndex, kNoIndex, kNoIndex});
  for (Index f = 0; f < triangles.size(); ++f) {
    poll(context, f);
    const TexCoord* uv = &geometry.corner_texcoords[3 * std::size_t{input_triangle(surface, f)}];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3;
      const Index a = triangles[f][c], b = triangles[f][d];
      sides.push_back(a < b ? Side{a, b, f, uv[c], uv[d]} : Side{b, a, f, uv[d], uv[c]});
    }
  }
  std::size_t compared = 0;
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    poll(context, compared++);
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    poll(context, begin);
    while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high) ++end;
    if (end - begin != 2) continue;
    const Side &a = sides[begin], &b = sides[begin + 1];
    if (a.at_low != b.at_low || a.at_high != b.at_high) {
      seams.push_back({a.low, a.high});
    } else if (a.face != b.face) {
      connect(a.face, b.face);
      connect(b.face, a.face);
    }
  }
}

TexCoord texcoord_at(const Geometry& input, const Surface& surface, Index face, const Vec3& query) {
  const std::array<Vec3, 3> corner = corners_of(surface.mesh, face);
  const Vec3 point = closest_point_on_triangle(query, corner[0], corner[1], corner[2]);
  const Weights weights = weights_at(point, corner);
  const TexCoord* uv = &input.corner_texcoords[3 * std::size_t{input_triangle(surface, face)}];
  TexCoord result{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double value = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (weights[k] > 0.0) value += weights[k] * static_cast<double>(uv[k][axis]);
    }
    result[axis] = static_cast<float>(value);
  }
  return result;
}

// Walks over the atlas from one face to the one that is closest to a point. So it never crosses a seam, and where both
// sides of a seam meet the point it ends on the side that it came from.
class AtlasWalk {
 public:
  AtlasWalk(const Atlas& atlas, const TriangleMesh& mesh) : atlas_(atlas), mesh_(mesh) {}

  struct End {
    Index face;
    bool arrived;  // as close as `least_sq`
  };
  // Ends when a face is as close as `least_sq`, or when all ways on lead farther off than the start is; the ways are
  // followed twice as far off where that gets there.
  End walk(Index from, const Vec3& target, double least_sq) {
    const Step start(distance_sq(from, target), from);
    const Step near = search(start, target, least_sq, start.first);
    if (near.first <= least_sq) return {near.second, true};
    const Step far = search(start, target, least_sq, 4.0 * start.first);
    return far.first <= least_sq ? End{far.second, true} : End{near.second, false};
  }

 private:
  using Step = std::pair<double, Index>;  // squared distance, face

  Step search(const Step& start, const Vec3& target, double least_sq, double farthest_sq) {
    constexpr std::size_t kMaxFaces = 256;
    met_.assign(1, start.second);
    open_.assign(1, start);
    Step best = start;
    while (!open_.empty() && best.first > least_sq && met_.size() < kMaxFaces) {
      std::pop_heap(open_.begin(), open_.end(), std::greater<>());
      const Index face = open_.back().second;
      open_.pop_back();
      for (const Index next : atlas_.neighbors[face]) {
        if (next == kNoIndex || std::find(met_.begin(), met_.end(), next) != met_.end()) continue;
        met_.push_back(next);
        const Step step(distance_sq(next, target), next);
        if (step.first > farthest_sq) continue;
        open_.push_back(step);
        best = std::min(best, step);
        std::push_heap(open_.begin(), open_.end(), std::greater<>());
      }
    }
    return best;
  }

  [[nodiscard]] double distance_sq(Index face, const Vec3& target) const {
    const auto [a, b, c] = corners_of(mesh_, face);
    return (closest_point_on_triangle(target, a, b, c) - target).squaredNorm();
  }

  const Atlas& atlas_;
  const TriangleMesh& mesh_;
  std::vector<Index> met_;
  std::vector<Step> open_;  // a heap, closest first
};

// The input faces whose texture coordinates an output face's corners get. A seam that was shortened may leave the
// face's centre on the other side; then another place of the face is the start from which all corners can be reached.
std::array<Index, 3> faces_for_corners(const TriangleTree& tree, AtlasWalk& atlas, const std::array<Vec3, 3>& corner) {
  const Vec3 center = (corner[0] + corner[1] + corner[2]) / 3.0;
  std::array<Index, 3> best{};
  int best_arrived = -1;
  Index hint = kNoIndex;
  for (const Vec3& place :
       {center, Vec3(0.5 * (center + corner[0])), Vec3(0.5 * (center + corner[1])), Vec3(0.5 * (center + corner[2]))}) {
    hint = tree.closest(place, hint).triangle;
    std::array<Index, 3> faces{};
    int arrived = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const AtlasWalk::End end = atlas.walk(hint, corner[c], tree.closest(corner[c], hint).distance_sq);
      faces[c] = end.face;
      arrived += end.arrived;
    }
    if (arrived > best_arrived) best = faces;
    best_arrived = std::max(best_arrived, arrived);
    if (arrived == 3) break;
  }
  return best;
}

std::vector<TexCoord> transfer_texcoords(const Geometry& input, const Surface& surface, const TriangleTree& tree,
                                         const TriangleMesh& output, const RunContext& context) {
  const Atlas atlas(input, surface, context);
  std::vector<TexCoord> result(3 * output.triangles.size());
  parallel::for_chunks(context, output.triangles.size(), [&](std::size_t begin, std::size_t end) {
    AtlasWalk walk(atlas, surface.mesh);
    for (std::size_t f = begin; f < end; ++f) {
      const std::array<Vec3, 3> corner = corners_of(output, f);
      std::array<Index, 3> faces{};
      if (atlas.seams.empty()) {
        for (std::size_t c = 0; c < 3; ++c) faces[c] = tree.closest(corner[c]).triangle;
      } else {
        faces = faces_for_corners(tree, walk, corner);
      }
      for (std::size_t c = 0; c < 3; ++c) result[3 * f + c] = texcoord_at(input, surface, faces[c], corner[c]);
    }
  });
  return result;
}

}  // namespace

FeatureEdges texture_seams(const Geometry& geometry, const Surface& surface, const RunContext& context) {
  if (geometry.corner_texcoords.empty()) return {};
  return Atlas(geometry, surface, context).seams;
}

void transfer_attributes(const Geometry& input, const Surface& surface, const SimplifiedMesh& simplified,
                         Placement placement, Geometry& output, const RunContext& context) {
  const bool interpolates = placement == Placement::Optimal && !input.attributes.empty();
  std::optional<TriangleTree> tree;
  if (interpolates || !input.triangle_attributes.empty() || !input.corner_texcoords.empty()) {
    tree.emplace(surface.mesh, context);
  }
  const TriangleMesh& mesh = simplified.mesh;
  output.attributes = interpolates ? interpolate_table(input.attributes,
                                                       places_on(*tree, surface.mesh, mesh.positions, context), context)
                                   : input.attributes.gather(simplified.source_vertex);
  if (!input.triangle_attributes.empty()) {
    std::vector<Vec3> centers(mesh.triangles.size());
    for (std::size_t f = 0; f < centers.size(); ++f) {
      poll(context, f);
      const auto [a, b, c] = corners_of(mesh, f);
      centers[f] = (a + b + c) / 3.0;
    }
    std::vector<Index> nearest;
    nearest.reserve(centers.size());
    for (const TriangleTree::Hit& hit : tree->closest(centers, context)) {
      nearest.push_back(input_triangle(surface, hit.triangle));
    }
    output.triangle_attributes = input.triangle_attributes.gather(nearest);
  }
  if (!input.corner_texcoords.empty()) {
    output.corner_texcoords = transfer_texcoords(input, surface, *tree, mesh, context);
  }
}

}  // namespace shapelight::pipeline
