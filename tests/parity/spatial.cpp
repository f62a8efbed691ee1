#include "recorder.hpp"
#include "shapelight/spatial/batch_queries.hpp"

namespace shapelight::parity {
namespace {

void record_all(const Recorder& recorder, const std::string& name, std::span<const Neighbor> found) {
  std::vector<double> distances;
  std::vector<Index> indices;
  for (const Neighbor& f : found) {
    distances.push_back(std::sqrt(f.distance_sq));
    indices.push_back(f.index);
  }
  recorder.record(name + ".distances", distances);
  recorder.record(name + ".indices", indices);
}

void record_kd_tree(const Recorder& recorder, const Geometry& mesh, std::span<const Vec3> queries) {
  const KdTree tree(mesh.positions);
  record_all(recorder, "KdTree.nearest", nearest(tree, queries, 1));
  record_all(recorder, "KdTree.nearest.5", nearest(tree, queries, 5, 0.15));
  const NeighborLists lists = within(tree, queries, 0.1);
  recorder.record("KdTree.within.offsets", lists.offsets);
  record_all(recorder, "KdTree.within", lists.found);
  recorder.record("KdTree.all_nearest", tree.all_nearest(4));
}

void record_triangle_tree(const Recorder& recorder, const Geometry& mesh, std::span<const Vec3> queries) {
  const TriangleTree tree(TriangleMesh{mesh.positions, mesh.triangles});
  std::vector<double> distances;
  std::vector<Index> triangles;
  std::vector<Vec3> points, normals;
  for (const TriangleTree::Hit& hit : tree.closest(queries)) {
    distances.push_back(std::sqrt(hit.distance_sq));
    triangles.push_back(hit.triangle);
    points.push_back(hit.point);
  }
  recorder.record("TriangleTree.closest.distances", distances);
  recorder.record("TriangleTree.closest.triangles", triangles);
  recorder.record("TriangleTree.closest.points", points);

  // Towards the origin, which the mesh surrounds: every ray hits.
  distances.clear(), triangles.clear(), points.clear();
  std::vector<Vec3> directions;
  for (const Vec3& query : queries) directions.push_back(-query);
  for (const TriangleTree::RayHit& hit : first_hits(tree, queries, directions)) {
    distances.push_back(hit ? hit.distance : std::numeric_limits<double>::infinity());
    triangles.push_back(hit.triangle);
    points.push_back(hit ? hit.point : Vec3::Constant(std::nan("")));
    normals.push_back(hit ? hit.normal : Vec3::Constant(std::nan("")));
  }
  recorder.record("TriangleTree.first_hit.distances", distances);
  recorder.record("TriangleTree.first_hit.triangles", triangles);
  recorder.record("TriangleTree.first_hit.points", points);
  recorder.record("TriangleTree.first_hit.normals", normals);

  points.clear();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    points.push_back(
        closest_point_on_triangle(queries[i], mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  recorder.record("closest_point_on_triangle", points);
}

}  // namespace

void record_spatial(const Recorder& recorder) {
  const Geometry mesh = data("meshes/fandisk.off");
  std::vector<Vec3> queries;
  for (std::size_t i = 0; i < mesh.size(); i += 3) queries.push_back(1.25 * mesh.positions[i]);
  record_kd_tree(recorder, mesh, queries);
  record_triangle_tree(recorder, mesh, queries);
}

}  // namespace shapelight::parity
