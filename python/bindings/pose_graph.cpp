#include "shapelight/registration/pose_graph.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/registration/joint_refinement.hpp"

namespace shapelight::python {
namespace {

using Poses = std::vector<PoseArray>;
using Clouds = std::pair<const RegistrationCloud*, const RegistrationCloud*>;  // full, samples

std::vector<RigidTransform> to_transforms(const Poses& poses) {
  std::vector<RigidTransform> transforms;
  for (const PoseArray& pose : poses) transforms.push_back(to_transform(pose));
  return transforms;
}

nb::list to_list(const std::vector<RigidTransform>& transforms) {
  nb::list poses;
  for (const RigidTransform& T : transforms) poses.append(to_numpy(T));
  return poses;
}

PoseGraphEdge to_edge(nb::handle edge) {
  using Covariance = nb::ndarray<const double, nb::shape<6, 6>, nb::c_contig, nb::device::cpu>;
  const auto covariance = nb::cast<Covariance>(edge["covariance"]);
  return {.target = nb::cast<std::size_t>(edge["target"]),
          .source = nb::cast<std::size_t>(edge["source"]),
          .T_target_source = to_transform(nb::cast<PoseArray>(edge["T_target_source"])),
          .covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance.data()),
          .confidence = nb::cast<double>(edge["confidence"])};
}

nb::dict disagreement_dict(const EdgeDisagreement& disagreement) {
  nb::dict d;
  d["rotation"] = disagreement.rotation;
  d["translation"] = disagreement.translation;
  d["chi_sq"] = disagreement.chi_sq;
  return d;
}

nb::dict edge_dict(const PoseGraphEdgeResult& edge) {
  nb::dict d;
  d["use"] = std::string(enum_name(edge.use));
  d["confidence"] = edge.confidence;
  d["loops_agree"] = edge.loops_agree;
  d["loops_disagree"] = edge.loops_disagree;
  d["disagreement"] = disagreement_dict(edge.disagreement);
  return d;
}

nb::dict pose_graph_job(std::size_t num_scans, const nb::list& edges, const nb::dict& given, nb::object threads,
                        nb::object progress) {
  const auto options = make_options<PoseGraphOptions>(given);
  std::vector<PoseGraphEdge> measured;
  for (const nb::handle edge : edges) measured.push_back(to_edge(edge));
  const PoseGraphResult result = run({threads, progress}, [&](const RunContext& context) {
    return optimize_pose_graph(num_scans, measured, options, context);
  });
  nb::dict d;
  nb::list edge_results;
  for (const PoseGraphEdgeResult& edge : result.edges) edge_results.append(edge_dict(edge));
  d["T_world_scan"] = to_list(result.T_world_scan);
  d["group"] = result.group;
  d["num_groups"] = result.num_groups;
  d["edges"] = edge_results;
  d["chi_sq_before"] = result.chi_sq_before;
  d["chi_sq_after"] = result.chi_sq_after;
  d["converged"] = result.converged;
  return d;
}

nb::dict fit_job(const Clouds& target, const Clouds& source, const PoseArray& T_target_source, const nb::dict& given) {
  const auto options = make_options<JointRefinementOptions>(given);
  const RigidTransform pose = to_transform(T_target_source);
  PairFit fit;
  {
    const nb::gil_scoped_release release;
    fit = measure_fit({target.first, target.second}, {source.first, source.second}, pose, options);
  }
  nb::dict d;
  d["overlap"] = fit.overlap;
  d["matches"] = fit.matches;
  d["rms"] = fit.rms;
  return d;
}

nb::dict refine_job(const std::vector<Clouds>& scans, const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                    const Poses& T_world_scan, const nb::dict& given, nb::object threads, nb::object progress) {
  const auto options = make_options<JointRefinementOptions>(given);
  std::vector<ScanView> views;
  for (const auto& [full, samples] : scans) views.push_back({full, samples});
  const std::vector<RigidTransform> start = to_transforms(T_world_scan);
  const JointRefinementResult result = run({threads, progress}, [&](const RunContext& context) {
    return refine_jointly(views, pairs, start, options, context);
  });
  nb::dict d;
  d["T_world_scan"] = to_list(result.T_world_scan);
  d["iterations"] = result.iterations;
  d["converged"] = result.converged;
  return d;
}

}  // namespace

void bind_pose_graph(nb::module_& module) {
  publish_options<PoseGraphOptions>(module, "optimize_pose_graph");
  module.def("optimize_pose_graph", &pose_graph_job, nb::arg("num_scans"), nb::arg("edges"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
  module.def(
      "measure_disagreement",
      [](const nb::dict& edge, const Poses& T_world_scan) {
        return disagreement_dict(measure_disagreement(to_edge(edge), to_transforms(T_world_scan)));
      },
      nb::arg("edge"), nb::arg("T_world_scan"));
  publish_options<JointRefinementOptions>(module, "refine_jointly");
  module.def("measure_fit", &fit_job, nb::arg("target"), nb::arg("source"), nb::arg("T_target_source"),
             nb::arg("options"));
  module.def("refine_jointly", &refine_job, nb::arg("scans"), nb::arg("pairs"), nb::arg("T_world_scan"),
             nb::arg("options"), nb::arg("threads").none(), nb::arg("progress").none());
}

}  // namespace shapelight::python
