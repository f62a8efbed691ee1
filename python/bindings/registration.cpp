#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "registration_results.hpp"
#include "run.hpp"
#include "shapelight/pipeline/register.hpp"
#include "shapelight/registration/coarse_alignment.hpp"
#include "shapelight/registration/ficp.hpp"
#include "shapelight/registration/icp.hpp"
#include "shapelight/registration/soft_icp.hpp"

namespace shapelight::python {
namespace {

std::vector<Vec3> copy_of(const std::optional<PointsArray>& points) {
  if (!points) return {};
  const std::span<const Vec3> all = as_span(*points);
  return {all.begin(), all.end()};
}

// Looks into a member of the object.
template <class Owner, class Member>
auto points_of(Member member) {
  return [member](nb::handle self) {
    const std::vector<Vec3>& points = nb::cast<const Owner&>(self).*member;
    return view_of(reinterpret_cast<const double*>(points.data()), {points.size(), 3}, self);
  };
}

void make_cloud(RegistrationCloud* self, const PointsArray& positions, const std::optional<PointsArray>& normals,
                const std::optional<std::array<double, 3>>& viewpoint, nb::object threads, nb::object progress) {
  std::vector<Vec3> points = copy_of(positions), directions = copy_of(normals);
  new (self) RegistrationCloud(run({threads, progress}, [&](const RunContext& context) {
    return RegistrationCloud(std::move(points), std::move(directions), context);
  }));
  if (viewpoint) self->viewpoint = to_vec3(*viewpoint);
}

void bind_clouds(nb::module_& module) {
  nb::class_<RegistrationCloud>(module, "RegistrationCloud", "What registration sees of one scan.")
      .def("__init__", &make_cloud, nb::arg("positions"), nb::arg("normals").none(), nb::arg("viewpoint").none(),
           nb::arg("threads").none(), nb::arg("progress").none())
      .def("__len__", &RegistrationCloud::size)
      .def_prop_ro("position", points_of<RegistrationCloud>(&RegistrationCloud::position))
      .def_prop_ro("normal", points_of<RegistrationCloud>(&RegistrationCloud::normal))
      .def_ro("spacing", &RegistrationCloud::spacing)
      .def_ro("diagonal", &RegistrationCloud::diagonal)
      .def_prop_ro("viewpoint", [](const RegistrationCloud& cloud) -> nb::object {
        return cloud.viewpoint ? to_numpy(*cloud.viewpoint) : nb::none();
      });
  nb::class_<PreparedScan>(module, "PreparedScan", "A scan made ready to be registered with others.")
      .def_prop_ro("origin", [](const PreparedScan& scan) { return to_numpy(scan.origin); })
      .def_ro("full", &PreparedScan::full)
      .def_ro("samples", &PreparedScan::samples)
      .def_prop_ro("keypoints", [](const PreparedScan& scan) { return to_numpy(std::vector<Index>(scan.keypoints)); });
}

PreparedScan prepare_job(const InputView& input, const std::string& name, const nb::dict& given, nb::object threads,
                         nb::object progress) {
  const auto options = make_options<RegisterOptions>(given);
  return run({threads, progress},
             [&](const RunContext& context) { return prepare_scan(input.view, options, name, context); });
}

nb::dict register_job(const PreparedScan& source, const PreparedScan& target, const std::optional<PoseArray>& init,
                      const nb::dict& given, nb::object threads, nb::object progress) {
  const auto options = make_options<RegisterOptions>(given);
  std::optional<RigidTransform> start;
  if (init) start = to_transform(*init);
  const RegisterResult result = run({threads, progress}, [&](const RunContext& context) {
    return register_scans(source, target, start, options, context);
  });
  return to_dict(result);
}

// One of the methods that iterate from a starting pose.
template <class Options, class Method>
void bind_method(nb::module_& module, const char* name, Method method) {
  publish_options<Options>(module, name);
  module.def(
      name,
      [method](const RegistrationCloud& source, const RegistrationCloud& target, const PoseArray& T_target_source,
               const nb::dict& given, nb::object threads, nb::object progress) {
        const auto options = make_options<Options>(given);
        const RigidTransform start = to_transform(T_target_source);
        return to_dict(run({threads, progress},
                           [&](const RunContext& context) { return method(source, target, start, options, context); }));
      },
      nb::arg("source"), nb::arg("target"), nb::arg("T_target_source"), nb::arg("options"), nb::arg("threads").none(),
      nb::arg("progress").none());
}

nb::dict describe_job(const RegistrationCloud& cloud, const VectorArray<Index>& keypoints, double spacing,
                      nb::object threads, nb::object progress) {
  DescribedPoints points = run({threads, progress}, [&](const RunContext& context) {
    return describe_points(cloud, as_span(keypoints), spacing, context);
  });
  nb::dict d;
  const std::size_t n = points.size();
  d["spacing"] = points.spacing;
  d["position"] = to_numpy(std::move(points.position));
  d["normal"] = to_numpy(std::move(points.normal));
  d["descriptor"] = own_as_numpy<float>(std::move(points.descriptor), {n, DescribedPoints::kBins});
  d["keypoints"] = to_numpy(std::move(points.keypoints));
  return d;
}

DescribedPoints to_described(const char* name, const nb::dict& d) {
  using Descriptors = nb::ndarray<const float, nb::shape<-1, DescribedPoints::kBins>, nb::c_contig, nb::device::cpu>;
  const auto descriptor = nb::cast<Descriptors>(d["descriptor"]);
  const auto keypoints = as_span(nb::cast<VectorArray<Index>>(d["keypoints"]));
  DescribedPoints points;
  points.spacing = nb::cast<double>(d["spacing"]);
  points.position = copy_of(nb::cast<PointsArray>(d["position"]));
  points.normal = copy_of(nb::cast<PointsArray>(d["normal"]));
  points.descriptor.assign(descriptor.data(), descriptor.data() + descriptor.size());
  points.keypoints.assign(keypoints.begin(), keypoints.end());
  if (points.normal.size() != points.size() || descriptor.shape(0) != points.size()) {
    throw InvalidInput(fmt::format("{}: {} positions, {} normals and {} descriptors, expected as many of each", name,
                                   points.size(), points.normal.size(), descriptor.shape(0)));
  }
  for (const Index i : points.keypoints) {
    if (i >= points.size()) throw InvalidInput(fmt::format("{}: keypoint {} >= {} points", name, i, points.size()));
  }
  return points;
}

nb::list align_job(const nb::dict& source, const nb::dict& target, const nb::dict& given, nb::object threads,
                   nb::object progress) {
  const auto options = make_options<CoarseAlignmentOptions>(given);
  const DescribedPoints moving = to_described("source", source), fixed = to_described("target", target);
  const auto found = run({threads, progress},
                         [&](const RunContext& context) { return align_coarsely(moving, fixed, options, context); });
  nb::list hypotheses;
  for (const PoseHypothesis& h : found) hypotheses.append(nb::make_tuple(to_numpy(h.T_target_source), h.support));
  return hypotheses;
}

nb::dict assess_job(const RegistrationCloud& source, const RegistrationCloud& target, const PoseArray& T_target_source,
                    const VectorArray<double>& rivals, nb::object threads, nb::object progress) {
  const RigidTransform pose = to_transform(T_target_source);
  return to_dict(run({threads, progress}, [&](const RunContext& context) {
    return assess_pose(source, target, pose, as_span(rivals), context);
  }));
}

}  // namespace

void bind_registration(nb::module_& module) {
  bind_clouds(module);
  module.def("prepare_scan", &prepare_job, nb::arg("scan"), nb::arg("name"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
  module.def("register_prepared", &register_job, nb::arg("source"), nb::arg("target"), nb::arg("init").none(),
             nb::arg("options"), nb::arg("threads").none(), nb::arg("progress").none());
  bind_method<IcpOptions>(module, "register_by_icp", &register_by_icp);
  bind_method<FicpOptions>(module, "register_by_ficp", &register_by_ficp);
  bind_method<SoftIcpOptions>(module, "register_by_soft_icp", &register_by_soft_icp);
  module.def("coarse_spacing", &coarse_spacing, nb::arg("cloud"));
  module.def("describe_points", &describe_job, nb::arg("cloud"), nb::arg("keypoints"), nb::arg("spacing"),
             nb::arg("threads").none(), nb::arg("progress").none());
  publish_options<CoarseAlignmentOptions>(module, "align_coarsely");
  module.def("align_coarsely", &align_job, nb::arg("source"), nb::arg("target"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
  module.def("assess_pose", &assess_job, nb::arg("source"), nb::arg("target"), nb::arg("T_target_source"),
             nb::arg("rivals"), nb::arg("threads").none(), nb::arg("progress").none());
}

}  // namespace shapelight::python
