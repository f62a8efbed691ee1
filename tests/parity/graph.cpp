#include "recorder.hpp"
#include "shapelight/graph/build_graph.hpp"

namespace shapelight::parity {
namespace {

void record_all(const Recorder& recorder, const std::string& name, const BuiltGraph& built) {
  const SurfaceGraph& graph = built.graph;
  recorder.record(name + ".offsets", graph.offsets);
  recorder.record(name + ".neighbors", graph.neighbors);
  recorder.record(name + ".weight", graph.weight);
  recorder.record(name + ".position", graph.position);
  recorder.record(name + ".normal", graph.normal);
  recorder.record(name + ".area", graph.area);
  recorder.record(name + ".boundary", graph.boundary);
  recorder.record(name + ".outlier", graph.outlier);
  recorder.record(name + ".global_id", graph.global_id);
  recorder.record(name + ".vertex_of_point", graph.vertex_of_point);
  recorder.record(name + ".origin", std::vector<Vec3>{graph.origin});
  recorder.record(name + ".mean_edge_length", graph.mean_edge_length);
  recorder.record(name + ".total_area", graph.total_area);
  const GraphDiagnostics& d = built.diagnostics;
  recorder.record(
      name + ".diagnostics",
      std::vector<std::size_t>{d.non_finite_points, d.duplicate_points, d.isolated_vertices, d.outliers,
                               d.non_manifold_edges, d.degenerate_triangles, d.boundary_vertices, d.components});
}

}  // namespace

void record_graph(const Recorder& recorder) {
  const Geometry mesh = data("meshes/fandisk.off");
  const Geometry scan = data("scans/bun000_quarter.rif");
  const Geometry cloud = data("clouds/simple.las");
  record_all(recorder, "build_graph.mesh", build_graph(mesh));
  record_all(recorder, "build_graph.range_image", build_graph(scan, {.depth_jump = 3.0}));
  record_all(recorder, "build_graph.cloud", build_graph(cloud, {.neighbors = 9}));
  record_all(recorder, "graph_from_mesh", graph_from_mesh(mesh.positions, mesh.triangles));
  record_all(recorder, "graph_from_range_image",
             graph_from_range_image(scan.positions, *scan.grid, Vec3(0.0, 0.0, 2.0), {.depth_jump = 4.0}));
  record_all(recorder, "graph_from_points",
             graph_from_points(cloud.positions, cloud.positions[0], {.neighbors = 7, .flag_outliers = false}));
  record_all(recorder, "graph_of_places", graph_of_places(cloud.positions));
  recorder.record("range_image_triangles", range_image_triangles(scan.positions, *scan.grid, Vec3(0.0, 0.0, 2.0), 4.0));
  const BuiltGraph built = build_graph(mesh);
  RingCollector rings(built.graph);
  recorder.record("RingCollector.collect", rings.collect(17, 3, 20));
}

}  // namespace shapelight::parity
