#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/spatial/triangle_tree.hpp"
#include "shapelight/synthetic/scan_pair.hpp"

namespace shapelight::python {
namespace {

using Triple = std::array<double, 3>;

nb::dict scan_dict(VirtualScan&& scan) {
  nb::dict d;
  d["geometry"] = to_dict(std::move(scan.geometry));
  d["T_mesh_scan"] = to_numpy(scan.T_mesh_scan);
  return d;
}

nb::dict camera_dict(const VirtualCamera& camera) {
  nb::dict d;
  d["T_mesh_camera"] = to_numpy(camera.T_mesh_camera);
  d["field_of_view"] = camera.field_of_view;
  return d;
}

TriangleTree tree_of(const InputView& surface, const RunContext& context) {
  const MeshView mesh = surface.mesh();
  return TriangleTree({{mesh.positions.begin(), mesh.positions.end()}, {mesh.triangles.begin(), mesh.triangles.end()}},
                      context);
}

nb::dict scan_job(const InputView& surface, const PoseArray& T_mesh_camera, double field_of_view, const nb::dict& given,
                  nb::object threads, nb::object progress) {
  const auto options = make_options<VirtualScanOptions>(given);
  const VirtualCamera camera{to_transform(T_mesh_camera), field_of_view};
  return scan_dict(run({threads, progress}, [&](const RunContext& context) {
    const TriangleTree tree = tree_of(surface, context.phase(0.0, 0.3, "index the surface"));
    return virtual_scan(tree, camera, options, context.phase(0.3, 1.0, "scan"));
  }));
}

nb::dict pair_job(const InputView& surface, const Triple& center, double radius, const nb::dict& given,
                  nb::object threads, nb::object progress) {
  const auto options = make_options<ScanPairOptions>(given);
  ScanPair pair = run({threads, progress}, [&](const RunContext& context) {
    const TriangleTree tree = tree_of(surface, context.phase(0.0, 0.1, "index the surface"));
    return scan_pair(tree, {to_vec3(center), radius}, options, context.phase(0.1, 1.0, "scan"));
  });
  nb::dict d;
  d["source"] = scan_dict(std::move(pair.source));
  d["target"] = scan_dict(std::move(pair.target));
  d["T_target_source"] = to_numpy(pair.T_target_source);
  d["overlap"] = pair.overlap;
  d["azimuth_between"] = pair.azimuth_between;
  return d;
}

double overlap_job(const InputView& source, const InputView& target, const PoseArray& T_target_source,
                   nb::object threads, nb::object progress) {
  const Geometry moving = source.geometry(), fixed = target.geometry();
  const RigidTransform pose = to_transform(T_target_source);
  return run({threads, progress},
             [&](const RunContext& context) { return scan_overlap(moving, fixed, pose, context); });
}

nb::list ring(const Triple& center, double radius, int count, double azimuth, double elevation, double field_of_view) {
  nb::list cameras;
  for (const VirtualCamera& c : ring_of_cameras({to_vec3(center), radius}, count, azimuth, elevation, field_of_view)) {
    cameras.append(camera_dict(c));
  }
  return cameras;
}

}  // namespace

void bind_synthetic(nb::module_& module) {
  publish_options<VirtualScanOptions>(module, "virtual_scan");
  module.def("virtual_scan", &scan_job, nb::arg("surface"), nb::arg("T_mesh_camera"), nb::arg("field_of_view"),
             nb::arg("options"), nb::arg("threads").none(), nb::arg("progress").none());
  publish_options<ScanPairOptions>(module, "scan_pair");
  module.def("scan_pair", &pair_job, nb::arg("surface"), nb::arg("center"), nb::arg("radius"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
  module.def("scan_overlap", &overlap_job, nb::arg("source"), nb::arg("target"), nb::arg("T_target_source"),
             nb::arg("threads").none(), nb::arg("progress").none());
  module.def(
      "bounding_sphere",
      [](const PointsArray& positions) {
        const BoundingSphere sphere = bounding_sphere(as_span(positions));
        return nb::make_tuple(to_numpy(sphere.center), sphere.radius);
      },
      nb::arg("positions"));
  module.def(
      "camera_on_sphere",
      [](const Triple& center, double radius, double azimuth, double elevation, double field_of_view, double distance) {
        return camera_dict(camera_on_sphere({to_vec3(center), radius}, azimuth, elevation, field_of_view, distance));
      },
      nb::arg("center"), nb::arg("radius"), nb::arg("azimuth"), nb::arg("elevation"), nb::arg("field_of_view"),
      nb::arg("distance"));
  module.def("ring_of_cameras", &ring, nb::arg("center"), nb::arg("radius"), nb::arg("count"), nb::arg("azimuth"),
             nb::arg("elevation"), nb::arg("field_of_view"));
}

}  // namespace shapelight::python
