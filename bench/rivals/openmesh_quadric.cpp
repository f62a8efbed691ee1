// OpenMesh's quadric decimater with its normal flipping check, down to an exact number of vertices.
//   openmesh_quadric IN.off OUT.off VERTICES
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/Property.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "off_mesh.hpp"

namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

/// OpenMesh refuses faces that would make an edge complex; they are counted.
Mesh to_openmesh(const rivals::OffMesh& mesh, std::size_t& left_out) {
  Mesh result;
  std::vector<Mesh::VertexHandle> handles;
  for (const rivals::Point& p : mesh.points) handles.push_back(result.add_vertex({p[0], p[1], p[2]}));
  for (const rivals::Triangle& t : mesh.triangles)
    if (!result.add_face(handles[t[0]], handles[t[1]], handles[t[2]]).is_valid()) ++left_out;
  return result;
}

void decimate(Mesh& mesh, std::size_t target) {
  mesh.request_face_normals();
  mesh.update_face_normals();
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to(target);
  mesh.garbage_collection();
}

rivals::OffMesh to_off(const Mesh& mesh) {
  rivals::OffMesh result;
  for (const auto vertex : mesh.vertices()) {
    const Mesh::Point p = mesh.point(vertex);
    result.points.push_back({p[0], p[1], p[2]});
  }
  for (const auto face : mesh.faces()) {
    rivals::Triangle triangle{};
    std::size_t corner = 0;
    for (auto it = mesh.cfv_iter(face); it.is_valid(); ++it) triangle[corner++] = static_cast<std::uint32_t>(it->idx());
    result.triangles.push_back(triangle);
  }
  return result;
}

int run(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: openmesh_quadric IN.off OUT.off VERTICES\n");
    return 2;
  }
  std::size_t left_out = 0;
  Mesh mesh = to_openmesh(rivals::read_off(argv[1]), left_out);
  const double start = rivals::cpu_seconds();
  decimate(mesh, std::strtoul(argv[3], nullptr, 10));
  const double seconds = rivals::cpu_seconds() - start;
  const rivals::OffMesh result = to_off(mesh);
  rivals::write_off(argv[2], result);
  std::printf("{\"cpu_seconds\": %.6f, \"vertices\": %zu, \"faces_left_out\": %zu}\n", seconds, result.points.size(),
              left_out);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "openmesh_quadric: %s\n", error.what());
    return 1;
  }
}
