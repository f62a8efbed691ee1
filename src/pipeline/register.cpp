#include "shapelight/pipeline/register.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pipeline/starting_poses.hpp"
#include "registration/surface_pairs.hpp"
#include "shapelight/registration/ficp.hpp"
#include "shapelight/registration/icp.hpp"
#include "shapelight/registration/soft_icp.hpp"

namespace shapelight {
namespace {

constexpr int kPolishSteps = 10;
constexpr double kPolishGate = 4.0;           // of the full target's spacings, at least
constexpr std::size_t kFinishPoints = 20000;  // of the source polish the best pose once more

RegistrationResult run_method(const PreparedScan& source, const PreparedScan& target, const StartingPose& start,
                              const RegisterOptions& options, const RunContext& context) {
  const auto by_icp = [&](IcpMetric metric) {
    IcpOptions icp;
    icp.metric = metric;
    icp.max_distance = options.max_distance;
    return register_by_icp(source.samples, target.samples, start.T_target_source, icp, context);
  };
  FicpOptions ficp;
  switch (options.method) {
    case RegistrationMethod::Icp:
      return by_icp(IcpMetric::Point);
    case RegistrationMethod::Plane:
      return by_icp(IcpMetric::Plane);
    case RegistrationMethod::Gicp:
      return by_icp(IcpMetric::Gicp);
    case RegistrationMethod::SoftIcp:
      return register_by_soft_icp(source.samples, target.samples, start.T_target_source, {}, context);
    case RegistrationMethod::FicpPure:
      ficp.start_lambda = ficp.lambda;
      break;
    case RegistrationMethod::Ficp:
      if (start.is_close) ficp.start_lambda = ficp.lambda;
      break;
  }
  return register_by_ficp(source.samples, target.samples, start.T_target_source, ficp, context);
}

// A few steps of some points of the source against the full surface of the target, which its samples only hint at.
// Pairs farther apart than the surfaces' own gate have no say. Plane to plane: on scans of known truth it is three to a
// hundred times closer than point to plane, whose pairs across edges pull.
RigidTransform polish(const PreparedScan& source, const RegistrationCloud& points, const PreparedScan& target,
                      const RigidTransform& T_target_source, const RunContext& context) {
  std::vector<registration::SurfacePair> pairs =
      registration::pair_surfaces(points, target.full, T_target_source, context);
  registration::forget_sides(pairs, source.full, target.full);
  IcpOptions icp;
  icp.metric = IcpMetric::Gicp;
  icp.max_distance = registration::find_gate(pairs, registration::widest_gate(source.full, target.full),
                                             kPolishGate * target.full.spacing)
                         .width;
  icp.max_iterations = kPolishSteps;
  const RegistrationResult polished = register_by_icp(points, target.full, T_target_source, icp, context);
  return polished.stop == StopReason::TooFewPairs ? T_target_source : polished.T_target_source;
}

// Every n-th point, so that at most `count` are left; they lie in Morton order, so the whole scan is covered evenly.
RegistrationCloud thin_out(const RegistrationCloud& cloud, std::size_t count, const RunContext& context) {
  const std::size_t step = (cloud.size() + count - 1) / count;
  std::vector<Vec3> position, normal;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    position.push_back(cloud.position[i]);
    normal.push_back(cloud.normal[i]);
  }
  return RegistrationCloud(std::move(position), std::move(normal), context);
}

// Where one start led.
struct Attempt {
  RegistrationResult registration;
  RigidTransform T_target_source;  // polished
  double fit = 0.0;
};

Attempt attempt_from(const PreparedScan& source, const PreparedScan& target, const StartingPose& start,
                     const RegisterOptions& options, const RunContext& context) {
  Attempt attempt;
  attempt.registration = run_method(source, target, start, options, context.phase(0.0, 0.7, "register"));
  attempt.T_target_source = attempt.registration.T_target_source;
  if (options.polish) {
    attempt.T_target_source =
        polish(source, source.samples, target, attempt.T_target_source, context.phase(0.7, 1.0, "polish"));
  }
  attempt.fit = fit_of_samples(source, target, attempt.T_target_source, context);
  return attempt;
}

void attempt_all(const PreparedScan& source, const PreparedScan& target, std::span<const StartingPose> starts,
                 const RegisterOptions& options, std::vector<Attempt>& attempts, const RunContext& context) {
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const auto fraction = [&](std::size_t done) {
      return static_cast<double>(done) / static_cast<double>(starts.size());
    };
    attempts.push_back(
        attempt_from(source, target, starts[i], options, context.phase(fraction(i), fraction(i + 1), "register")));
  }
  std::stable_sort(attempts.begin(), attempts.end(), [](const Attempt& a, const Attempt& b) { return a.fit > b.fit; });
}

// The best attempt first; then what the best would be were the source turned to look like itself again.
std::vector<Attempt> attempts_from(const PreparedScan& source, const PreparedScan& target, const StartingPoses& starts,
                                   const RegisterOptions& options, const RunContext& context) {
  std::vector<Attempt> attempts;
  attempt_all(source, target, starts.poses, options, attempts, context.phase(0.0, 0.7, "register"));
  std::vector<StartingPose> rivals;
  for (const RigidTransform& T_source_source : starts.T_source_source) {
    rivals.push_back({attempts.front().T_target_source * T_source_source, true});
  }
  attempt_all(source, target, rivals, options, attempts, context.phase(0.7, 1.0, "look for rivals"));
  return attempts;
}

// The poses that are neither like the first nor like each other: near the first one's fit, the answer is ambiguous.
std::vector<double> rival_fits(const std::vector<Attempt>& attempts, double diagonal) {
  std::vector<const Attempt*> distinct;
  std::vector<double> fits;
  for (const Attempt& attempt : attempts) {
    const bool is_new = std::none_of(distinct.begin(), distinct.end(), [&](const Attempt* other) {
      return are_alike(attempt.T_target_source, other->T_target_source, diagonal);
    });
    if (!is_new) continue;
    if (!distinct.empty()) fits.push_back(attempt.fit);
    distinct.push_back(&attempt);
  }
  return fits;
}

RigidTransform to_origins(const RigidTransform& T_target_source, const PreparedScan& source,
                          const PreparedScan& target) {
  RigidTransform local = T_target_source;
  local.translation() = T_target_source * source.origin - target.origin;
  return local;
}

RigidTransform to_input(const RigidTransform& local, const PreparedScan& source, const PreparedScan& target) {
  RigidTransform T_target_source = local;
  // Steps that were multiplied up are a rotation to twelve digits only.
  T_target_source.linear() = Eigen::Quaterniond(local.linear()).normalized().toRotationMatrix();
  T_target_source.translation() = target.origin + local.translation() - T_target_source.linear() * source.origin;
  return T_target_source;
}

}  // namespace

RegisterResult register_scans(const PreparedScan& source, const PreparedScan& target,
                              const std::optional<RigidTransform>& T_target_source_init, const RegisterOptions& options,
                              const RunContext& context) {
  validate_options(options);
  const bool search = !T_target_source_init && options.coarse;
  StartingPoses starts;
  if (search) {
    starts = find_starting_poses(source, target, context.phase(0.0, 0.4, "find starting poses"));
  } else {
    const RigidTransform init = T_target_source_init.value_or(RigidTransform::Identity());
    starts.poses.push_back({to_origins(init, source, target), false});
  }
  std::vector<Attempt> attempts =
      attempts_from(source, target, starts, options, context.phase(search ? 0.4 : 0.0, 0.8, "register"));

  RegisterResult result;
  Attempt& best = attempts.front();
  if (options.polish) {
    const RunContext finish = context.phase(0.8, 0.9, "polish");
    best.T_target_source =
        polish(source, thin_out(source.full, kFinishPoints, finish), target, best.T_target_source, finish);
  }
  result.T_target_source = to_input(best.T_target_source, source, target);
  result.fit = best.fit;
  std::vector<double> rivals = rival_fits(attempts, source.full.diagonal);
  result.rival_fit = rivals.empty() ? 0.0 : rivals.front();
  for (double& rival : rivals) rival /= std::max(best.fit, 1e-12);
  result.assessment =
      assess_pose(source.full, target.full, best.T_target_source, rivals, context.phase(0.9, 1.0, "assess the pose"));
  result.registration = std::move(best.registration);
  result.source_samples = source.samples.size();
  result.target_samples = target.samples.size();
  result.hypotheses = search ? attempts.size() : 0;
  return result;
}

RegisterResult register_scans(const GeometryView& source, const GeometryView& target,
                              const std::optional<RigidTransform>& T_target_source_init, const RegisterOptions& options,
                              const RunContext& context) {
  RegisterOptions preparing = options;
  preparing.coarse = options.coarse && !T_target_source_init;
  const PreparedScan prepared_source =
      prepare_scan(source, preparing, "source", context.phase(0.0, 0.3, "prepare the source"));
  const PreparedScan prepared_target =
      prepare_scan(target, preparing, "target", context.phase(0.3, 0.6, "prepare the target"));
  RegisterResult result = register_scans(prepared_source, prepared_target, T_target_source_init, options,
                                         context.phase(0.6, 1.0, "register"));
  context.report(1.0, "done");
  return result;
}

}  // namespace shapelight
