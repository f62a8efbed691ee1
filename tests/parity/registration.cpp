#include "recorder.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/pipeline/register.hpp"
#include "shapelight/registration/coarse_alignment.hpp"
#include "shapelight/registration/ficp.hpp"
#include "shapelight/registration/icp.hpp"
#include "shapelight/registration/joint_refinement.hpp"
#include "shapelight/registration/pose_graph.hpp"
#include "shapelight/registration/soft_icp.hpp"

namespace shapelight::parity {
namespace {

void record_prepared(const Recorder& recorder, const PreparedScan& scan) {
  recorder.record("prepare_scan.origin", std::vector<Vec3>{scan.origin});
  recorder.record("prepare_scan.full", scan.full.position);
  recorder.record("prepare_scan.normal", scan.full.normal);
  recorder.record("prepare_scan.samples", scan.samples.position);
  recorder.record("prepare_scan.keypoints", scan.keypoints);
}

// Back in the frame of the file.
RegistrationCloud in_input_frame(const RegistrationCloud& cloud, const Vec3& origin) {
  std::vector<Vec3> positions = cloud.position;
  for (Vec3& p : positions) p += origin;
  return RegistrationCloud(std::move(positions), cloud.normal);
}

void record_result(const Recorder& recorder, const std::string& name, const RegistrationResult& result) {
  recorder.record(name, result.T_target_source);
  recorder.record(name + ".error", result.error);
  recorder.record(name + ".numbers",
                  std::vector<double>{static_cast<double>(result.iterations), result.inlier_ratio, result.rms});
}

void record_coarse(const Recorder& recorder, const PreparedScan& source, const PreparedScan& target) {
  const double spacing = std::max(coarse_spacing(source.full), coarse_spacing(target.full));
  recorder.record("coarse_spacing", spacing);
  const DescribedPoints moving = describe_points(source.full, source.keypoints, spacing);
  const DescribedPoints fixed = describe_points(target.full, target.keypoints, spacing);
  recorder.record("describe_points.position", moving.position);
  recorder.record("describe_points.normal", moving.normal);
  recorder.record("describe_points.descriptor", moving.descriptor);
  recorder.record("describe_points.keypoints", moving.keypoints);
  std::vector<double> support;
  const auto hypotheses = align_coarsely(moving, fixed, {.same_side = true, .max_hypotheses = 3});
  for (const PoseHypothesis& h : hypotheses) support.push_back(h.support);
  recorder.record("align_coarsely", hypotheses.at(0).T_target_source);
  recorder.record("align_coarsely.support", support);
}

void record_graph(const Recorder& recorder, const RigidTransform& T) {
  const RigidTransform start = RigidTransform::Identity();
  std::vector<PoseGraphEdge> edges(3);
  for (std::size_t e = 0; e < 3; ++e) {
    edges[e].target = e / 2;
    edges[e].source = e == 0 ? 1 : 2;
    edges[e].T_target_source = T;
    edges[e].covariance *= 0.25;
    edges[e].confidence = 0.9;
  }
  const PoseGraphResult graph = optimize_pose_graph(3, edges, {.min_confidence = 0.1});
  for (std::size_t i = 0; i < 3; ++i) recorder.record("pose_graph." + std::to_string(i), graph.T_world_scan[i]);
  recorder.record("pose_graph.chi_sq", std::vector<double>{graph.chi_sq_before, graph.chi_sq_after});
  const std::vector<RigidTransform> poses = {start, T, T};
  const EdgeDisagreement d = measure_disagreement(edges[2], poses);
  recorder.record("measure_disagreement", std::vector<double>{d.rotation, d.translation, d.chi_sq});
}

}  // namespace

void record_registration(const Recorder& recorder) {
  const Geometry turned = data("scans/dragonStandRight_24.ply"), dragon = data("scans/dragonStandRight_0.ply");
  const RigidTransform T = read_transform(SHAPELIGHT_DATA_DIR "/scans/T_dragonStandRight_24_to_0.txt");
  const PreparedScan source = prepare_scan(turned), target = prepare_scan(dragon);
  record_prepared(recorder, source);
  const RegisterResult registered = register_scans(source, target, T);
  recorder.record("register_prepared", registered.T_target_source);
  recorder.record("register_prepared.confidence", registered.assessment.confidence);
  record_coarse(recorder, source, target);

  const RegistrationCloud moving = in_input_frame(source.samples, source.origin);
  const RegistrationCloud fixed = in_input_frame(target.samples, target.origin);
  recorder.record("registration_cloud", std::vector<double>{moving.spacing, moving.diagonal});
  record_result(recorder, "register_by_icp", register_by_icp(moving, fixed, T, {.metric = IcpMetric::Gicp}));
  record_result(recorder, "register_by_ficp", register_by_ficp(moving, fixed, T, {.lambda = 1.0}));
  record_result(recorder, "register_by_soft_icp", register_by_soft_icp(moving, fixed, T, {.candidates = 2}));

  const RegistrationCloud moving_full = in_input_frame(source.full, source.origin);
  const RegistrationCloud fixed_full = in_input_frame(target.full, target.origin);
  const std::vector<double> rivals = {0.5};
  const PoseAssessment pose = assess_pose(moving_full, fixed_full, T, rivals);
  recorder.record("assess_pose", std::vector<double>{pose.confidence, pose.overlap, pose.residual, pose.gate,
                                                     pose.reciprocal.mean, pose.reciprocal.std, pose.rival_weight});
  recorder.record("assess_pose.covariance", std::span<const double>(pose.covariance.data(), 36));  // column by column

  const ScanView a{&fixed_full, &fixed}, b{&moving_full, &moving};
  const PairFit fit = measure_fit(a, b, T, {.max_distance = 4.0});
  recorder.record("measure_fit", std::vector<double>{fit.overlap, static_cast<double>(fit.matches), fit.rms});
  const std::vector<ScanView> scans = {a, b};
  const std::vector<std::pair<std::size_t, std::size_t>> pairs = {{0, 1}};
  const std::vector<RigidTransform> start = {RigidTransform::Identity(), T};
  recorder.record("refine_jointly", refine_jointly(scans, pairs, start).T_world_scan[1]);
  record_graph(recorder, T);
}

}  // namespace shapelight::parity
