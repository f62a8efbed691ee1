#include "recorder.hpp"
#include "shapelight/synthetic/scan_pair.hpp"

namespace shapelight::parity {
namespace {

void record_scan(const Recorder& recorder, const std::string& name, const VirtualScan& scan) {
  recorder.record(name + ".positions", scan.geometry.positions);
  recorder.record(name + ".grid", scan.geometry.grid->pixel);
  recorder.record(name + ".T_mesh_scan", scan.T_mesh_scan);
}

}  // namespace

void record_synthetic(const Recorder& recorder) {
  const Geometry fandisk = data("meshes/fandisk.off");
  const TriangleTree surface({fandisk.positions, fandisk.triangles});
  const BoundingSphere sphere = bounding_sphere(fandisk.positions);
  recorder.record("bounding_sphere.center", std::vector<Vec3>{sphere.center});
  recorder.record("bounding_sphere.radius", sphere.radius);

  const VirtualCamera camera = camera_on_sphere(sphere, 0.4, 0.2, 0.6, 4.0);
  recorder.record("camera_on_sphere", camera.T_mesh_camera);
  recorder.record("ring_of_cameras", ring_of_cameras(sphere, 5, 0.1, 0.3).back().T_mesh_camera);

  VirtualScanOptions options;
  options.width = 80;
  options.height = 60;
  options.noise = 0.01;
  options.dropout = 0.1;
  options.random_pose = true;
  options.seed = 3;
  record_scan(recorder, "virtual_scan", virtual_scan(surface, camera, options));

  ScanPairOptions pair_options;
  pair_options.overlap = 0.6;
  pair_options.scan = options;
  const ScanPair pair = scan_pair(surface, sphere, pair_options);
  record_scan(recorder, "scan_pair.source", pair.source);
  record_scan(recorder, "scan_pair.target", pair.target);
  recorder.record("scan_pair.T_target_source", pair.T_target_source);
  recorder.record("scan_pair.overlap", std::vector<double>{pair.overlap, pair.azimuth_between});
  recorder.record("scan_overlap", scan_overlap(pair.source.geometry, pair.target.geometry, pair.T_target_source));
}

}  // namespace shapelight::parity
