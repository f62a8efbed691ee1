#include "pipeline/simplify_surface.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/poll.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::pipeline {
namespace {

void check_pixels(const GeometryView& geometry) {
  const RangeGrid& grid = *geometry.grid;
  if (grid.pixel.size() != std::size_t{grid.width} * grid.height) {
    throw InvalidInput("range image: the number of pixels is not width x height");
  }
  for (std::size_t i = 0; i < grid.pixel.size(); ++i) {
    if (grid.pixel[i] != kNoIndex && grid.pixel[i] >= geometry.size()) {
      throw InvalidInput(
          fmt::format("range image: pixel {}: point {} >= {} points", i, grid.pixel[i], geometry.size()));
    }
  }
}

// All pixels wind alike, so either all faces look the right way or none does.
void turn_to_viewer(const GeometryView& geometry, const Vec3& center, std::vector<Triangle>& triangles) {
  double towards = 0.0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 &p = geometry.positions[a], &q = geometry.positions[b], &r = geometry.positions[c];
    const Vec3 normal = (q - p).cross(r - p);
    towards += geometry.viewpoint ? normal.dot(*geometry.viewpoint - p) : normal.dot(p - center);
  }
  if (towards >= 0.0) return;
  for (Triangle& t : triangles) std::swap(t[1], t[2]);
}

}  // namespace

Surface make_surface(const GeometryView& geometry, const GraphOptions& options, const RunContext& context) {
  Surface surface;
  surface.origin = bounding_box(geometry.positions).center();
  surface.mesh.positions.reserve(geometry.size());
  context.check();
  for (const Vec3& p : geometry.positions) surface.mesh.positions.push_back(p - surface.origin);
  if (geometry.kind() == GeometryKind::RangeImage) {
    check_pixels(geometry);
    surface.mesh.triangles =
        range_image_triangles(geometry.positions, *geometry.grid, geometry.viewpoint, options.depth_jump, context);
    turn_to_viewer(geometry, surface.origin, surface.mesh.triangles);
    return surface;
  }
  for (Index t = 0; t < geometry.triangles.size(); ++t) {
    poll(context, t);
    bool finite = true;
    for (const Index v : geometry.triangles[t]) {
      if (v >= geometry.size()) {
        throw InvalidInput(fmt::format("triangle {}: vertex {} >= {} vertices", t, v, geometry.size()));
      }
      finite = finite && geometry.positions[v].allFinite();
    }
    if (!finite) continue;
    surface.mesh.triangles.push_back(geometry.triangles[t]);
    surface.triangle_of.push_back(t);
  }
  surface.skipped_triangles = geometry.triangles.size() - surface.mesh.triangles.size();
  if (surface.skipped_triangles == 0) surface.triangle_of.clear();
  return surface;
}

}  // namespace shapelight::pipeline
