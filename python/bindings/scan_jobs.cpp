#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "registration_results.hpp"
#include "run.hpp"
#include "shapelight/pipeline/align.hpp"
#include "shapelight/pipeline/register.hpp"

namespace shapelight::python {
namespace {

nb::object matrix_to_numpy(const Matrix6& matrix) {
  const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> rows = matrix;
  return own_as_numpy<double>(std::vector<double>(rows.data(), rows.data() + 36), {6, 6});
}

nb::dict register_job(const InputView& source, const InputView& target, const std::optional<PoseArray>& init,
                      const nb::dict& given, nb::object threads, nb::object progress) {
  const auto options = make_options<RegisterOptions>(given);
  std::optional<RigidTransform> start;
  if (init) start = to_transform(*init);
  const RegisterResult result = run({threads, progress}, [&](const RunContext& context) {
    return register_scans(source.view, target.view, start, options, context);
  });
  return to_dict(result);
}

nb::dict pair_dict(const AlignedPair& pair) {
  nb::dict d;
  d["target"] = pair.target;
  d["source"] = pair.source;
  d["T_target_source"] = to_numpy(pair.T_target_source);
  d["use"] = std::string(enum_name(pair.graph.use));
  d["confidence"] = pair.graph.confidence;
  d["registration_confidence"] = pair.registration_confidence;
  d["overlap"] = pair.overlap;
  d["closes_loop"] = pair.closes_loop;
  d["rms_before"] = pair.rms_before;
  d["rms_after"] = pair.rms_after;
  return d;
}

nb::dict scan_dict(const AlignedScan& scan) {
  nb::dict d;
  d["T_world_scan"] = to_numpy(scan.T_world_scan);
  d["group"] = scan.group;
  d["partners"] = scan.partners;
  d["rms"] = scan.rms;
  return d;
}

nb::dict align_job(const std::vector<const InputView*>& inputs, bool wants_merged, const nb::dict& given,
                   nb::object threads, nb::object progress) {
  const auto options = make_options<AlignOptions>(given);
  std::vector<GeometryView> views;
  for (const InputView* input : inputs) views.push_back(input->view);
  const AlignResult result =
      run({threads, progress}, [&](const RunContext& context) { return align_scans(views, options, context); });
  nb::dict d;
  nb::list scans, pairs;
  for (const AlignedScan& scan : result.scans) scans.append(scan_dict(scan));
  for (const AlignedPair& pair : result.pairs) pairs.append(pair_dict(pair));
  d["scans"] = scans;
  d["pairs"] = pairs;
  d["num_groups"] = result.num_groups;
  d["num_placed"] = result.num_placed;
  d["chi_sq_before"] = result.chi_sq_before;
  d["chi_sq_after"] = result.chi_sq_after;
  d["warnings"] = result.warnings;
  d["merged"] = nb::none();
  if (wants_merged) {
    std::vector<Geometry> whole;
    for (const InputView* input : inputs) whole.push_back(input->geometry());
    d["merged"] = to_dict(merge_scans(whole, result));
  }
  return d;
}

}  // namespace

nb::dict to_dict(const PoseAssessment& pose) {
  nb::dict d;
  d["mean_error"] = pose.reciprocal.mean;
  d["std_error"] = pose.reciprocal.std;
  d["reciprocal_share"] = pose.reciprocal.share;
  d["overlap"] = pose.overlap;
  d["residual"] = pose.residual;
  d["gate"] = pose.gate;
  d["contrast"] = pose.contrast;
  d["normal_agreement"] = pose.normal_agreement;
  d["in_free_space"] = pose.in_free_space;
  d["conditioning"] = pose.conditioning;
  d["weakest_direction"] = pose.weakest.name;
  d["weakest_uncertainty"] = pose.weakest.uncertainty;
  d["covariance"] = matrix_to_numpy(pose.covariance);
  d["rival_weight"] = pose.rival_weight;
  d["confidence"] = pose.confidence;
  d["doubt"] = pose.doubt;
  return d;
}

nb::dict to_dict(const RegistrationResult& result) {
  nb::dict d;
  d["T_target_source"] = to_numpy(result.T_target_source);
  d["converged"] = result.converged();
  d["stop"] = std::string(stop_reason_name(result.stop));
  d["iterations"] = result.iterations;
  d["inlier_ratio"] = result.inlier_ratio;
  d["rms"] = result.rms;
  d["error"] = to_numpy(std::vector<double>(result.error));
  return d;
}

nb::dict to_dict(const RegisterResult& result) {
  nb::dict d = to_dict(result.assessment);
  d["T_target_source"] = to_numpy(result.T_target_source);
  const nb::dict iteration = to_dict(result.registration);
  for (const char* name : {"converged", "stop", "iterations", "inlier_ratio", "rms"}) d[name] = iteration[name];
  d["source_samples"] = result.source_samples;
  d["target_samples"] = result.target_samples;
  d["hypotheses"] = result.hypotheses;
  d["fit"] = result.fit;
  d["rival_fit"] = result.rival_fit;
  d["warnings"] = result.warnings;
  return d;
}

void bind_scan_jobs(nb::module_& module) {
  publish_options<RegisterOptions>(module, "register");
  module.def("register_scans", &register_job, nb::arg("source"), nb::arg("target"), nb::arg("init").none(),
             nb::arg("options"), nb::arg("threads").none(), nb::arg("progress").none());
  publish_options<AlignOptions>(module, "align");
  module.def("align_scans", &align_job, nb::arg("scans"), nb::arg("merged"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none());
}

}  // namespace shapelight::python
