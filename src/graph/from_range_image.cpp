#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "graph/finish_graph.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/graph/build_graph.hpp"

namespace shapelight {
namespace {

// Edge lengths of a range image in multiples of what neighbouring pixels are apart.
class PixelSpacing {
 public:
  PixelSpacing(std::span<const Vec3> positions, const RangeGrid& grid, const std::optional<Vec3>& viewpoint,
               const RunContext& context)
      : positions_(positions), viewpoint_(viewpoint) {
    std::vector<double> lengths;
    for (std::size_t row = 0; row < grid.height; ++row) {
      context.check();
      for (std::size_t column = 0; column < grid.width; ++column) {
        const std::size_t pixel = row * grid.width + column;
        if (column + 1 < grid.width) add(grid.pixel[pixel], grid.pixel[pixel + 1], lengths);
        if (row + 1 < grid.height) add(grid.pixel[pixel], grid.pixel[pixel + grid.width], lengths);
      }
    }
    if (lengths.empty()) return;
    context.check();
    std::nth_element(lengths.begin(), lengths.begin() + lengths.size() / 2, lengths.end());
    median_ = lengths[lengths.size() / 2];
  }

  [[nodiscard]] bool is_point(Index i) const { return i != kNoIndex && positions_[i].allFinite(); }
  [[nodiscard]] double relative_length(Index a, Index b) const { return measure(a, b) / median_; }

 private:
  // With a viewpoint pixels fan out, so lengths are taken relative to the distance.
  [[nodiscard]] double measure(Index a, Index b) const {
    const double length = (positions_[a] - positions_[b]).norm();
    if (!viewpoint_) return length;
    return length / std::min((positions_[a] - *viewpoint_).norm(), (positions_[b] - *viewpoint_).norm());
  }
  void add(Index a, Index b, std::vector<double>& lengths) const {
    if (is_point(a) && is_point(b)) lengths.push_back(measure(a, b));
  }

  std::span<const Vec3> positions_;
  std::optional<Vec3> viewpoint_;
  double median_ = 1.0;
};

}  // namespace

std::vector<Triangle> range_image_triangles(std::span<const Vec3> positions, const RangeGrid& grid,
                                            const std::optional<Vec3>& viewpoint, double depth_jump,
                                            const RunContext& context) {
  const PixelSpacing spacing(positions, grid, viewpoint, context);
  std::vector<Triangle> triangles;
  const auto add = [&](Index a, Index b, Index c) {
    for (const Index i : {a, b, c}) {
      if (!spacing.is_point(i)) return;
    }
    const double longest =
        std::max({spacing.relative_length(a, b), spacing.relative_length(b, c), spacing.relative_length(c, a)});
    if (longest <= depth_jump * std::sqrt(2.0)) triangles.push_back({a, b, c});  // a diagonal is that much longer
  };
  for (std::size_t row = 0; row + 1 < grid.height; ++row) {
    context.check();
    for (std::size_t column = 0; column + 1 < grid.width; ++column) {
      const Index* top = &grid.pixel[row * grid.width + column];
      const Index* bottom = top + grid.width;
      const std::array<Index, 4> corner = {top[0], bottom[0], bottom[1], top[1]};  // counter-clockwise, rows downwards
      const bool has_first = spacing.is_point(corner[0]) && spacing.is_point(corner[2]);
      const bool has_second = spacing.is_point(corner[1]) && spacing.is_point(corner[3]);
      const bool first = has_first && (!has_second || spacing.relative_length(corner[0], corner[2]) <=
                                                          spacing.relative_length(corner[1], corner[3]));
      if (first) {
        add(corner[0], corner[1], corner[2]);
        add(corner[0], corner[2], corner[3]);
      } else if (has_second) {
        add(corner[0], corner[1], corner[3]);
        add(corner[1], corner[2], corner[3]);
      }
    }
  }
  return triangles;
}

BuiltGraph graph_from_range_image(std::span<const Vec3> positions, const RangeGrid& grid,
                                  const std::optional<Vec3>& viewpoint, const GraphOptions& options,
                                  const RunContext& context) {
  validate_options(options);
  if (grid.pixel.size() != std::size_t{grid.width} * grid.height) {
    throw InvalidInput("range image: the number of pixels is not width x height");
  }
  for (std::size_t i = 0; i < grid.pixel.size(); ++i) {
    if (grid.pixel[i] != kNoIndex && grid.pixel[i] >= positions.size()) {
      throw InvalidInput(
          fmt::format("range image: pixel {}: point {} >= {} points", i, grid.pixel[i], positions.size()));
    }
  }
  const RunContext cut = context.phase(0.0, 0.3, "cut depth jumps");
  const std::vector<Triangle> triangles = range_image_triangles(positions, grid, viewpoint, options.depth_jump, cut);
  BuiltGraph built = graph_from_mesh(positions, triangles, context.phase(0.3, 1.0, "connect pixels"));
  orient_as_one(built.graph, viewpoint, context);
  return built;
}

BuiltGraph build_graph(const GeometryView& geometry, const GraphOptions& options, const RunContext& context) {
  switch (geometry.kind()) {
    case GeometryKind::Mesh:
      return graph_from_mesh(geometry.positions, geometry.triangles, context);
    case GeometryKind::RangeImage:
      return graph_from_range_image(geometry.positions, *geometry.grid, geometry.viewpoint, options, context);
    case GeometryKind::Cloud:
      break;
  }
  return graph_from_points(geometry.positions, geometry.viewpoint, options, context);
}

}  // namespace shapelight
