// Quadric edge collapse beside other libraries, every run in turn with the others, on one thread:
//   quadric_collapse [--keep RATIO] [--repeat N] [--slow] [--output DIR] MESH...
// CPU time from input arrays to output arrays, best of N. --slow adds CGAL and OpenMesh (once), --output writes the
// results for surface_error.py to judge.
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "shapelight/io/io.hpp"
#include "shapelight/simplify/qslim.hpp"
#include "simplify/manifold_mesh.hpp"
#ifdef SHAPELIGHT_HAVE_OPENMESH
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#endif
#ifdef SHAPELIGHT_HAVE_CGAL
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#endif

namespace {

using namespace shapelight;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Job {
  TriangleMesh mesh;         // as read, unused vertices left out
  TriangleMesh manifold;     // cut into sheets, for those who want no other
  std::size_t vertices;      // target
  std::size_t faces, edges;  // what ours has at that target
};

struct Program {
  std::string name;
  bool slow;
  std::function<TriangleMesh(const Job&, double& seconds)> run;
};

TriangleMesh run_ours(const Job& job, Placement placement, double& seconds) {
  RunContext context;
  context.max_threads = 1;
  QslimOptions options;
  options.placement = placement;
  const double start = cpu_seconds();
  SimplifiedMesh result = simplify_qslim(job.mesh, {.vertices = job.vertices}, options, {}, context);
  seconds = cpu_seconds() - start;
  return std::move(result.mesh);
}

TriangleMesh run_meshoptimizer(const Job& job, double& seconds) {
  std::vector<float> positions;
  for (const Vec3& p : job.mesh.positions) {
    for (const double x : p) positions.push_back(static_cast<float>(x));
  }
  std::vector<unsigned> indices;
  for (const Triangle& t : job.mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  std::vector<unsigned> result(indices.size());
  const double start = cpu_seconds();
  const std::size_t count = meshopt_simplify(result.data(), indices.data(), indices.size(), positions.data(),
                                             positions.size() / 3, 12, 3 * job.faces, 1.0f, 0, nullptr);
  seconds = cpu_seconds() - start;
  TriangleMesh mesh;
  mesh.positions = job.mesh.positions;
  for (std::size_t i = 0; i < count; i += 3) mesh.triangles.push_back({result[i], result[i + 1], result[i + 2]});
  return mesh;
}

#ifdef SHAPELIGHT_HAVE_OPENMESH
struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

TriangleMesh run_openmesh(const Job& job, double& seconds) {
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
  const double start = cpu_seconds();
  Mesh mesh;
  std::vector<Mesh::VertexHandle> handles;
  for (const Vec3& p : job.manifold.positions) handles.push_back(mesh.add_vertex({p.x(), p.y(), p.z()}));
  for (const auto& [a, b, c] : job.manifold.triangles) mesh.add_face(handles[a], handles[b], handles[c]);
  mesh.request_face_normals();
  mesh.update_face_normals();
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to(job.vertices);
  mesh.garbage_collection();
  TriangleMesh result;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    result.positions.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces()) {
    Triangle t{};
    std::size_t corner = 0;
    for (const auto v : mesh.fv_range(f)) t[corner++] = static_cast<Index>(v.idx());
    result.triangles.push_back(t);
  }
  seconds = cpu_seconds() - start;
  return result;
}
#endif

#ifdef SHAPELIGHT_HAVE_CGAL
TriangleMesh run_cgal(const Job& job, double& seconds) {
  namespace Sms = CGAL::Surface_mesh_simplification;
  using Kernel = CGAL::Simple_cartesian<double>;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : job.manifold.positions) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::vector<std::size_t>> polygons;
  for (const Triangle& t : job.manifold.triangles) polygons.emplace_back(t.begin(), t.end());
  Mesh mesh;
  const double start = cpu_seconds();
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  using Policies = Sms::GarlandHeckbert_plane_policies<Mesh, Kernel>;
  const Policies policies(mesh);
  Sms::edge_collapse(mesh, Sms::Count_stop_predicate<Mesh>(job.edges),
                     CGAL::parameters::get_cost(policies.get_cost())
                         .get_placement(policies.get_placement())
                         .filter(Sms::Bounded_normal_change_filter<>()));
  seconds = cpu_seconds() - start;
  mesh.collect_garbage();
  TriangleMesh result;
  for (const auto v : mesh.vertices())
    result.positions.emplace_back(mesh.point(v)[0], mesh.point(v)[1], mesh.point(v)[2]);
  for (const auto f : mesh.faces()) {
    Triangle t{};
    std::size_t corner = 0;
    for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh)) t[corner++] = static_cast<Index>(v);
    result.triangles.push_back(t);
  }
  return result;
}
#endif

Job make_job(const std::filesystem::path& path, double keep) {
  const Geometry geometry = read_geometry(path);
  Job job;
  RunContext context;
  // All vertices kept: what is not used by a triangle is left out.
  job.mesh = simplify_qslim({geometry.positions, geometry.triangles}, {.vertices = geometry.size()}).mesh;
  job.manifold = simplification::make_manifold(job.mesh, {}, context, nullptr).mesh;
  job.vertices = static_cast<std::size_t>(keep * static_cast<double>(job.mesh.positions.size()) + 0.5);
  double seconds = 0.0;
  const TriangleMesh ours = run_ours(job, Placement::Input, seconds);
  job.faces = ours.triangles.size();
  job.edges = job.vertices + job.faces + job.manifold.triangles.size() * 3 / 2 - job.manifold.positions.size() -
              job.manifold.triangles.size();
  return job;
}

std::vector<Program> programs() {
  std::vector<Program> list{
      {"shapelight-input", false, [](const Job& job, double& s) { return run_ours(job, Placement::Input, s); }},
      {"meshoptimizer", false, run_meshoptimizer},
      {"shapelight-optimal", false, [](const Job& job, double& s) { return run_ours(job, Placement::Optimal, s); }}};
#ifdef SHAPELIGHT_HAVE_OPENMESH
  list.push_back({"openmesh", true, run_openmesh});
#endif
#ifdef SHAPELIGHT_HAVE_CGAL
  list.push_back({"cgal", true, run_cgal});
#endif
  return list;
}

}  // namespace

int main(int argc, char** argv) {
  double keep = 0.1;
  int repeat = 5;
  bool slow = false;
  std::filesystem::path output;
  std::vector<std::filesystem::path> meshes;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--keep" && i + 1 < argc) {
      keep = std::stod(argv[++i]);
    } else if (word == "--repeat" && i + 1 < argc) {
      repeat = std::stoi(argv[++i]);
    } else if (word == "--output" && i + 1 < argc) {
      output = argv[++i];
    } else if (word == "--slow") {
      slow = true;
    } else {
      meshes.emplace_back(word);
    }
  }
  fmt::print("{:<16} {:<20} {:>9} {:>9} {:>9} {:>10}\n", "mesh", "program", "vertices", "faces", "CPU s", "us/vertex");
  for (const auto& path : meshes) {
    const Job job = make_job(path, keep);
    const std::vector<Program> list = programs();
    std::vector<double> best(list.size(), 1e30);
    std::vector<TriangleMesh> results(list.size());
    for (int round = 0; round < repeat; ++round) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i].slow && (!slow || round > 0)) continue;
        double seconds = 0.0;
        results[i] = list[i].run(job, seconds);
        best[i] = std::min(best[i], seconds);
      }
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (results[i].triangles.empty()) continue;
      std::vector<std::uint8_t> used(results[i].positions.size(), 0);
      for (const Triangle& t : results[i].triangles) used[t[0]] = used[t[1]] = used[t[2]] = 1;
      const auto vertices = std::count(used.begin(), used.end(), 1);
      fmt::print("{:<16} {:<20} {:>9} {:>9} {:>9.4f} {:>10.3f}\n", path.stem().string(), list[i].name, vertices,
                 results[i].triangles.size(), best[i], 1e6 * best[i] / static_cast<double>(job.mesh.positions.size()));
      if (output.empty()) continue;
      Geometry geometry;
      geometry.positions = std::move(results[i].positions);
      geometry.triangles = std::move(results[i].triangles);
      std::filesystem::create_directories(output);
      write_geometry(output / fmt::format("{}.{}.ply", path.stem().string(), list[i].name), geometry);
    }
    std::fflush(stdout);
  }
}
