#include "shapelight/pipeline/measure.hpp"

#include <fmt/format.h>

#include "shapelight/core/error.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kVariationNeighbors = 30;  // of the features that coverage is measured on

// The surface of a mesh or a range image, without triangles at points that were never measured; none of a cloud.
TriangleMesh surface_of(const GeometryView& geometry, std::string_view name, std::vector<std::string>& warnings) {
  TriangleMesh mesh{{geometry.positions.begin(), geometry.positions.end()}, {}};
  if (geometry.kind() == GeometryKind::RangeImage) {
    mesh.triangles =
        range_image_triangles(geometry.positions, *geometry.grid, geometry.viewpoint, GraphOptions{}.depth_jump);
  } else {
    mesh.triangles.assign(geometry.triangles.begin(), geometry.triangles.end());
  }
  const auto is_unmeasured = [&](Index v) { return v < mesh.positions.size() && !mesh.positions[v].allFinite(); };
  const std::size_t dropped = std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return is_unmeasured(t[0]) || is_unmeasured(t[1]) || is_unmeasured(t[2]);
  });
  if (dropped > 0) warnings.push_back(fmt::format("{}: {} triangles at non-finite vertices: ignored", name, dropped));
  return mesh;
}

std::vector<Vec3> finite_points(const GeometryView& geometry) {
  std::vector<Vec3> points;
  for (const Vec3& p : geometry.positions) {
    if (p.allFinite()) points.push_back(p);
  }
  return points;
}

SamplingQuality measure_points(const GeometryView& reference_geometry, const GeometryView& test_geometry,
                               const RunContext& context) {
  const std::vector<Vec3> reference = finite_points(reference_geometry), test = finite_points(test_geometry);
  const std::vector<double> importance =
      surface_variation_knn(reference, kVariationNeighbors, context.phase(0.0, 0.5, "surface variation"));
  return measure_sampling(reference, importance, test, context.phase(0.5, 1.0, "coverage"));
}

}  // namespace

MeasureResult measure(const GeometryView& reference, const GeometryView& test, const SurfaceDistanceOptions& options,
                      const RunContext& context) {
  validate_options(options);
  MeasureResult result;
  result.diagonal = bounding_box(reference.positions).diagonal();
  const TriangleMesh from = surface_of(reference, "reference", result.warnings);
  const TriangleMesh to = surface_of(test, "test", result.warnings);
  if (from.triangles.empty() || to.triangles.empty()) {
    result.points = measure_points(reference, test, context);
  } else {
    result.surfaces = measure_surface_distance(from, to, options, context);
  }
  context.report(1.0, "done");
  return result;
}

std::vector<double> distances_to_surface(const GeometryView& reference, const GeometryView& test,
                                         const RunContext& context) {
  std::vector<std::string> ignored;
  const TriangleMesh surface = surface_of(reference, "reference", ignored);
  if (surface.triangles.empty()) throw InvalidInput("reference: has no triangles, expected a surface");
  const TriangleTree tree(surface, context.phase(0.0, 0.3, "surface tree"));
  return vertex_distances({test.positions, {}}, tree, context.phase(0.3, 1.0, "distances"));
}

}  // namespace shapelight
