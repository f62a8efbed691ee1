#include "recorder.hpp"
#include "shapelight/simplify/qslim.hpp"
#include "shapelight/simplify/ssim.hpp"

namespace shapelight::parity {
namespace {

void record_mesh(const Recorder& recorder, const std::string& name, const SimplifiedMesh& result) {
  recorder.record(name + ".vertices", result.mesh.positions);
  recorder.record(name + ".faces", result.mesh.triangles);
  recorder.record(name + ".source_vertex", result.source_vertex);
}

void record_oddities(const Recorder& recorder, const std::string& name, const MeshOddities& o) {
  recorder.record(name, std::vector<std::uint64_t>{o.degenerate_faces, o.duplicate_faces, o.reoriented_faces,
                                                   o.split_vertices, o.locked_vertices, o.unused_vertices});
}

}  // namespace

void record_simplify(const Recorder& recorder) {
  const Geometry fandisk = data("meshes/fandisk.off");
  TriangleMesh mesh{fandisk.positions, fandisk.triangles};
  std::vector<Index> samples;
  for (Index v = 0; v < mesh.positions.size(); v += 10) samples.push_back(v);
  std::vector<Vec3> denoised = mesh.positions;
  for (Vec3& p : denoised) p *= 1.0625;  // exact in binary
  FeatureEdges features;
  for (std::size_t t = 0; t < 300; ++t) features.push_back({mesh.triangles[t][0], mesh.triangles[t][1]});

  record_mesh(recorder, "simplify_qslim", simplify_qslim(mesh, {.vertices = 500, .faces = 0}));
  record_mesh(recorder, "simplify_qslim.optimal",
              simplify_qslim(mesh, {.vertices = 0, .faces = 2000},
                             {.placement = Placement::Optimal, .boundary_weight = 2.0}, features));
  record_mesh(
      recorder, "simplify_ssim",
      simplify_ssim(mesh, {.vertices = 700, .faces = 0}, {.samples = samples, .denoised = denoised}, {}, features));
  record_mesh(recorder, "simplify_ssim_paper",
              simplify_ssim_paper(mesh, {.vertices = 700, .faces = 0}, samples, features));

  mesh.triangles.push_back(mesh.triangles[7]);
  mesh.positions.emplace_back(0.0, 0.0, 0.0);
  MeshOddities oddities;
  record_mesh(recorder, "simplify_qslim.odd",
              simplify_qslim(mesh, {.vertices = 500, .faces = 0}, {}, {}, {}, &oddities));
  record_oddities(recorder, "simplify_qslim.oddities", oddities);
}

}  // namespace shapelight::parity
