#include "cancel_jobs.hpp"

#include <cmath>

#include "finer_mesh.hpp"
#include "shapelight/io/io.hpp"
#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/metrics/surface_distance.hpp"
#include "shapelight/pipeline/align.hpp"
#include "shapelight/pipeline/fields.hpp"
#include "shapelight/pipeline/register.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/pipeline/simplify.hpp"
#include "shapelight/render/renderer.hpp"
#include "shapelight/synthetic/virtual_scan.hpp"

namespace shapelight::bench {
namespace {

void add_files(std::vector<Job>& jobs, const JobInput& input) {
  struct File {
    const char* name;
    const Geometry* geometry;
    bool ascii;
  };
  const File files[] = {
      {"mesh.ply", &input.mesh, false},    {"mesh-text.ply", &input.mesh, true}, {"mesh.obj", &input.mesh, false},
      {"mesh.stl", &input.mesh, false},    {"mesh-text.stl", &input.mesh, true}, {"mesh.off", &input.mesh, false},
      {"cloud.ply", &input.cloud, false},  {"cloud.pcd", &input.cloud, false},   {"cloud-text.pcd", &input.cloud, true},
      {"cloud.xyz", &input.cloud, false},  {"cloud.las", &input.cloud, false},   {"scan.ply", &input.scans[0], false},
      {"scan.pcd", &input.scans[0], false}};
  for (const File& file : files) {
    const auto path = input.folder / file.name;
    const std::string what = path.filename().string();
    jobs.push_back({"file " + what + " write", [path, file](const RunContext& context) {
                      (void)write_geometry(path, *file.geometry, {.ascii = file.ascii, .overwrite = true}, context);
                    }});
    jobs.push_back(
        {"file " + what + " read", [path](const RunContext& context) { (void)read_geometry(path, {}, context); }});
  }
}

void add_sampling(std::vector<Job>& jobs, const std::string& kind, const Geometry& geometry) {
  const auto add = [&](const std::string& name, const SampleOptions& options) {
    jobs.push_back({"sample " + kind + " " + name, [&geometry, options](const RunContext& context) {
                      (void)sample(geometry, {.count = {}, .ratio = 0.1, .spacing = {}}, options, context);
                    }});
  };
  for (const auto& [method, name] : enum_names(SamplingMethod{})) {
    SampleOptions options = sample_preset(Preset::Detail);
    options.method = method;
    add(std::string(name), options);
  }
  add("paper", sample_preset(Preset::Paper));
  for (const Preset preset : {Preset::Detail, Preset::Paper}) {
    FieldsOptions options = fields_preset(preset);
    options.adaptive = false;  // every step runs
    jobs.push_back(
        {"fields " + kind + (preset == Preset::Paper ? " paper" : " detail"),
         [&geometry, options](const RunContext& context) { (void)point_fields(geometry, options, context); }});
  }
}

void add_simplifying(std::vector<Job>& jobs, const JobInput& input) {
  const auto add = [&](const std::string& name, const SimplifySize& size, const SimplifyOptions& options) {
    jobs.push_back({"simplify " + name, [&mesh = input.mesh, size, options](const RunContext& context) {
                      (void)simplify(mesh, size, options, context);
                    }});
  };
  const SimplifySize tenth{.vertices = {}, .faces = {}, .ratio = 0.1, .max_error = {}};
  for (const auto& [method, name] : enum_names(SimplifyMethod{})) {
    for (const Placement placement : {Placement::Input, Placement::Optimal}) {
      if (method == SimplifyMethod::SsimPaper && placement == Placement::Optimal) continue;
      SimplifyOptions options = simplify_preset(SimplifyPreset::Detail, placement);
      options.method = method;
      add(std::string(name) + (placement == Placement::Optimal ? " optimal" : ""), tenth, options);
    }
  }
  add("fast", tenth, simplify_preset(SimplifyPreset::Fast));
  add("best", tenth, simplify_preset(SimplifyPreset::Best));
  add("paper", tenth, simplify_preset(SimplifyPreset::Paper));
  const double error = 1e-3 * bounding_box(input.mesh.positions).diagonal();
  add("by error", {.vertices = {}, .faces = {}, .ratio = {}, .max_error = error}, {});
  SimplifyOptions qslim;
  qslim.method = SimplifyMethod::Qslim;
  jobs.push_back({"simplify sheets", [&mesh = input.crossed, tenth, qslim](const RunContext& context) {
                    (void)simplify(mesh, tenth, qslim, context);
                  }});
}

void add_registering(std::vector<Job>& jobs, const JobInput& input) {
  for (const auto& [method, name] : enum_names(RegistrationMethod{})) {
    RegisterOptions options;
    options.method = method;
    jobs.push_back({"register " + std::string(name), [&scans = input.scans, options](const RunContext& context) {
                      (void)register_scans(scans[1], scans[0], {}, options, context);
                    }});
  }
  RegisterOptions dense;
  dense.ratio = 0.2;
  jobs.push_back({"register fifth", [&scans = input.scans, dense](const RunContext& context) {
                    (void)register_scans(scans[1], scans[0], {}, dense, context);
                  }});
  jobs.push_back({"register clouds", [&clouds = input.clouds](const RunContext& context) {
                    (void)register_scans(clouds[1], clouds[0], {}, {}, context);
                  }});
  jobs.push_back({"align", [&scans = input.scans](const RunContext& context) {
                    (void)align_scans(views_of(scans), {}, context);
                  }});
}

void add_measuring(std::vector<Job>& jobs, const JobInput& input) {
  jobs.push_back({"metrics meshes", [&](const RunContext& context) {
                    (void)measure_surface_distance({input.mesh.positions, input.mesh.triangles},
                                                   {input.coarse.positions, input.coarse.triangles}, {}, context);
                  }});
  jobs.push_back({"metrics clouds", [&](const RunContext& context) {
                    const std::vector<double> importance(input.cloud.size(), 1.0);
                    (void)measure_sampling(input.cloud.positions, importance, input.coarse.positions, context);
                  }});
  jobs.push_back({"surface variation",
                  [&](const RunContext& context) { (void)surface_variation_knn(input.cloud.positions, 30, context); }});
  for (const auto* geometry : {&input.mesh, &input.cloud, &input.scans[0]}) {
    jobs.push_back(
        {"render " + std::string(geometry_kind_name(geometry->kind())), [geometry](const RunContext& context) {
           RenderItem item;
           item.geometry = geometry;
           (void)render_scene(std::span(&item, 1), {}, context);
         }});
  }
}

}  // namespace

JobInput make_input(const Geometry& mesh, std::size_t points, const std::filesystem::path& folder) {
  JobInput input;
  input.folder = folder;
  Index parts = 1;
  while (parts * parts * mesh.size() < points) ++parts;
  input.coarse.positions = mesh.positions;
  input.coarse.triangles = mesh.triangles;
  input.mesh = finer_mesh(input.coarse, parts);
  input.crossed = input.mesh;
  input.crossed.triangles.push_back({0, input.mesh.triangles[0][1], static_cast<Index>(points / 2)});
  std::vector<float> height;
  for (const Vec3& p : input.mesh.positions) height.push_back(static_cast<float>(p.y()));
  input.mesh.attributes.set({"height", std::move(height)});
  input.cloud.positions = input.mesh.positions;
  input.cloud.attributes = input.mesh.attributes;
  const TriangleTree surface(TriangleMesh{input.mesh.positions, input.mesh.triangles});
  VirtualScanOptions scan;
  scan.width = scan.height = static_cast<int>(1.7 * std::sqrt(static_cast<double>(points)));  // a third sees something
  scan.random_pose = true;
  const BoundingSphere sphere = bounding_sphere(input.mesh.positions);
  for (const double azimuth : {0.0, 0.5, 1.0}) {
    input.scans.push_back(virtual_scan(surface, camera_on_sphere(sphere, azimuth, 0.3), scan).geometry);
    ++scan.seed;
    input.clouds.emplace_back().positions = input.scans.back().positions;
  }
  return input;
}

std::vector<Job> all_jobs(const JobInput& input) {
  std::vector<Job> jobs;
  add_files(jobs, input);
  add_sampling(jobs, "mesh", input.mesh);
  add_sampling(jobs, "cloud", input.cloud);
  add_simplifying(jobs, input);
  add_registering(jobs, input);
  add_measuring(jobs, input);
  return jobs;
}

}  // namespace shapelight::bench
