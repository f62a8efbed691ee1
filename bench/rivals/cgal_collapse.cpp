// CGAL's edge collapse: Lindstrom-Turk or Garland-Heckbert, default weights, down to an exact number of vertices.
//   cgal_collapse lt|gh IN.off OUT.off VERTICES
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "off_mesh.hpp"

namespace {

namespace simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// CGAL's own stop predicates count edges.
struct VerticesLeft {
  std::size_t target;

  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile& profile, std::size_t, std::size_t) const {
    return profile.surface_mesh().number_of_vertices() <= target;
  }
};

/// Where more than two triangles meet at an edge, or sheets touch in a vertex, copies of vertices part them.
Mesh to_polygon_mesh(const rivals::OffMesh& mesh, std::size_t& copies) {
  std::vector<Kernel::Point_3> points;
  for (const rivals::Point& p : mesh.points) points.emplace_back(p[0], p[1], p[2]);
  std::vector<std::vector<std::size_t>> polygons;
  for (const rivals::Triangle& t : mesh.triangles) polygons.push_back({t[0], t[1], t[2]});
  if (!CGAL::Polygon_mesh_processing::is_polygon_soup_a_polygon_mesh(polygons))
    CGAL::Polygon_mesh_processing::orient_polygon_soup(points, polygons);
  copies = points.size() - mesh.points.size();
  Mesh result;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, polygons, result);
  return result;
}

void collapse(const std::string& method, Mesh& mesh, std::size_t target) {
  const VerticesLeft stop{target};
  if (method == "lt") {
    simplification::edge_collapse(mesh, stop,
                                  CGAL::parameters::get_cost(simplification::LindstromTurk_cost<Mesh>())
                                      .get_placement(simplification::LindstromTurk_placement<Mesh>()));
  } else {
    const simplification::GarlandHeckbert_plane_policies<Mesh, Kernel> policies(mesh);
    simplification::edge_collapse(
        mesh, stop, CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  }
}

rivals::OffMesh to_off(Mesh& mesh) {
  mesh.collect_garbage();
  rivals::OffMesh result;
  for (const auto vertex : mesh.vertices()) {
    const Kernel::Point_3& p = mesh.point(vertex);
    result.points.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto face : mesh.faces()) {
    rivals::Triangle triangle{};
    std::size_t corner = 0;
    for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      triangle[corner++] = static_cast<std::uint32_t>(vertex.idx());
    result.triangles.push_back(triangle);
  }
  return result;
}

int run(int argc, char** argv) {
  const std::string method = argc == 5 ? argv[1] : "";
  if (method != "lt" && method != "gh") {
    std::fprintf(stderr, "usage: cgal_collapse lt|gh IN.off OUT.off VERTICES\n");
    return 2;
  }
  std::size_t copies = 0;
  Mesh mesh = to_polygon_mesh(rivals::read_off(argv[2]), copies);
  const double start = rivals::cpu_seconds();
  collapse(method, mesh, std::strtoul(argv[4], nullptr, 10));
  const double seconds = rivals::cpu_seconds() - start;
  const rivals::OffMesh result = to_off(mesh);
  rivals::write_off(argv[3], result);
  std::printf("{\"cpu_seconds\": %.6f, \"vertices\": %zu, \"copies_of_input_vertices\": %zu}\n", seconds,
              result.points.size(), copies);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cgal_collapse: %s\n", error.what());
    return 1;
  }
}
