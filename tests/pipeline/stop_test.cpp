#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sample/cell_grid.hpp"
#include "sample/farthest_tree.hpp"
#include "sample/spread.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/metrics/surface_distance.hpp"
#include "shapelight/pipeline/register.hpp"
#include "shapelight/pipeline/simplify.hpp"
#include "shapelight/render/renderer.hpp"
#include "shapelight/segment/segmentation.hpp"
#include "shapelight/spatial/kd_tree.hpp"
#include "shapelight/spatial/triangle_tree.hpp"
#include "simplify/edge_uses.hpp"
#include "simplify/manifold_mesh.hpp"
#include "simplify/sheets.hpp"
#include "simplify/wedges.hpp"
#include "support/data_files.hpp"
#include "support/shapes.hpp"
#include "support/watch_progress.hpp"

// A stop is seen wherever it comes. Without clocks: at progress calls, and by every step that runs long on one thread.
namespace shapelight {
namespace {

using namespace shapelight::testing;

Geometry mesh_of(const Shape& shape) {
  Geometry geometry;
  geometry.positions = shape.positions;
  geometry.triangles = shape.triangles;
  return geometry;
}

TEST(Stop, EndsSimplifyingAtAnyPhase) {
  const Geometry mesh = mesh_of(sphere(3, 1.0, 0.2));
  for (const auto& [method, name] : enum_names(SimplifyMethod{})) {
    for (const Placement placement : {Placement::Input, Placement::Optimal}) {
      if (method == SimplifyMethod::SsimPaper && placement == Placement::Optimal) continue;
      SimplifyOptions options = simplify_preset(SimplifyPreset::Detail, placement);
      options.method = method;
      options.measure = true;
      SCOPED_TRACE(name);
      const Work work = [&](const RunContext& context) {
        (void)simplify(mesh, {.vertices = 100, .faces = {}, .ratio = {}, .max_error = {}}, options, context);
      };
      expect_cancel_everywhere(work, 3);
    }
  }
}

TEST(Stop, EndsRegisteringAtAnyPhase) {
  const Geometry target = read_data("scans/bun000_quarter.rif");
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.2, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Geometry source = transformed(target, turn, {5, 0, 0});
  for (const auto& [method, name] : enum_names(RegistrationMethod{})) {
    RegisterOptions options;
    options.method = method;
    SCOPED_TRACE(name);
    expect_cancel_everywhere(
        [&](const RunContext& context) { (void)register_scans(source, target, {}, options, context); }, 7);
  }
}

TEST(Stop, EndsMeasuringAndDrawingAtAnyPhase) {
  const Geometry mesh = mesh_of(sphere(3, 1.0)), cloud = as_cloud(mesh);
  const MeshView view(mesh.positions, mesh.triangles);
  const Work measure = [&](const RunContext& context) {
    (void)measure_surface_distance(view, view, {.samples = 1000}, context);
  };
  expect_cancel_everywhere(measure);
  for (const Geometry* geometry : {&mesh, &cloud}) {
    const Work draw = [&](const RunContext& context) {
      RenderItem item;
      item.geometry = geometry;
      RenderOptions options;
      options.width = options.height = 64;
      (void)render_scene(std::span(&item, 1), options, context);
    };
    expect_cancel_everywhere(draw);
  }
}

TEST(Stop, IsSeenByEveryStepThatRunsLongOnOneThread) {
  const Geometry mesh = mesh_of(sphere(5, 1.0)), cloud = as_cloud(mesh);
  const TriangleMesh surface{mesh.positions, mesh.triangles};
  const SurfaceGraph graph = build_graph(mesh, {}).graph;
  const std::vector<double> field(graph.size(), 0.0);
  const std::vector<Vec3>& points = mesh.positions;
  const CellGrid grid(points, 0.1, {});
  const std::vector<std::uint32_t> order = {0, 1, 2};
  MeshOddities oddities;
  const std::vector<std::pair<std::string, Work>> steps = {
      {"graph of a mesh", [&](const RunContext& context) { (void)build_graph(mesh, {}, context); }},
      {"graph of a cloud", [&](const RunContext& context) { (void)build_graph(cloud, {}, context); }},
      {"kd-tree", [&](const RunContext& context) { KdTree(points, context); }},
      {"triangle tree", [&](const RunContext& context) { TriangleTree(surface, context); }},
      {"farthest tree", [&](const RunContext& context) { FarthestTree(points, {}, context); }},
      {"cell grid", [&](const RunContext& context) { CellGrid(points, 0.1, context); }},
      {"cell size", [&](const RunContext& context) { (void)find_cell_size(points, 10, context); }},
      {"darts", [&](const RunContext& context) { (void)throw_darts(grid, order, 0.1, 3, context); }},
      {"segments", [&](const RunContext& context) { (void)segment_field(graph, field, {}, context); }},
      {"sheets",
       [&](const RunContext& context) {
         (void)simplification::cut_into_sheets(points, mesh.triangles, oddities, context);
       }},
      {"wedges",
       [&](const RunContext& context) {
         (void)simplification::collect_wedges(points.size(), mesh.triangles, context);
       }},
      {"edges", [&](const RunContext& context) { EdgeUses(surface, context); }},
  };
  std::stop_source stop;
  stop.request_stop();
  for (const auto& [name, step] : steps) {
    EXPECT_NO_THROW(step({})) << name;
    EXPECT_THROW(step({.stop = stop.get_token()}), Cancelled) << name;
  }
}

}  // namespace
}  // namespace shapelight
