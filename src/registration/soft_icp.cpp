#include "shapelight/registration/soft_icp.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "registration/closest_points.hpp"
#include "registration/iterate.hpp"
#include "registration/rigid_fit.hpp"
#include "registration/soft_matches.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kMinPoints = 10;
constexpr double kGate = 3.67;         // [sigma] farther candidates weigh less than a thousandth of the closest
constexpr double kLargestSigma = 0.2;  // [target diagonals]
constexpr double kMinWeight = 3.0;     // [pairs] less does not determine a motion

double first_sigma(const ClosestPoints& forward) {
  double sum = 0.0;
  for (std::size_t i = 0; i < forward.size(); ++i) sum += forward.match(i).distance_sq;
  return 2.0 * std::sqrt(sum / static_cast<double>(forward.size()));
}

std::optional<IterationStep> make_step(const SoftMatches& soft, const RegistrationCloud& target,
                                       const ClosestPoints& forward, const Vec3& origin) {
  RigidFit fit(origin);
  double weight = 0.0;
  double sum_sq = 0.0;
  for (const SoftMatch& match : soft.matches()) {
    fit.add(forward.moved(match.source), target.position[match.target], match.weight);
    weight += match.weight;
    sum_sq += match.weight * match.distance_sq;
  }
  if (weight < kMinWeight) return std::nullopt;
  const double rms = std::sqrt(sum_sq / weight);
  return IterationStep{.motion = fit.solve(),
                       .error = rms,
                       .inlier_ratio = std::min(1.0, weight / static_cast<double>(forward.size())),
                       .rms = rms};
}

}  // namespace

RegistrationResult register_by_soft_icp(const RegistrationCloud& source, const RegistrationCloud& target,
                                        const RigidTransform& T_target_source, const SoftIcpOptions& options,
                                        const RunContext& context) {
  validate_options(options);
  check_registration_input(source, target, T_target_source, kMinPoints);
  const bool single = options.candidates == 1;
  const double kappa = options.kappa > 0.0 ? options.kappa : (single ? 1.5 : 2.0);
  const double final_spacings = options.final_sigma > 0.0 ? options.final_sigma : (single ? 0.5 : 0.35);
  double final_sigma = final_spacings * std::max(source.spacing, target.spacing);

  const auto k = static_cast<std::size_t>(options.candidates);
  ClosestPoints forward(source.position, target, k);
  ClosestPoints backward(target.position, source, k);
  SoftMatches soft(source.size(), target.size());
  forward.update(T_target_source, context);
  const double first = first_sigma(forward);
  if (!(final_sigma > 0.0)) final_sigma = first > 0.0 ? first : 1.0;  // each cloud is a single place
  double sigma = std::max(std::min(first, kLargestSigma * target.diagonal), final_sigma);

  const auto step = [&](const RigidTransform& T) {
    forward.update(T, context, kGate * sigma);
    backward.update(T.inverse(), context, kGate * sigma);
    soft.collect(forward, backward);
    soft.weigh(sigma, kappa, options.balance_passes);
    return make_step(soft, target, forward, T.translation());
  };

  RegistrationResult result;
  result.T_target_source = T_target_source;
  const RunContext annealing = context.phase(0.0, 0.5, "softicp, annealing");
  const RunContext silent{context.max_threads, context.stop, {}};
  const double widest = std::log(sigma / final_sigma);
  bool enough = true;
  for (; enough && sigma > final_sigma; sigma = std::max(final_sigma, options.rate * sigma)) {
    annealing.report(1.0 - std::log(sigma / final_sigma) / widest);
    iterate(result, {.iterations = 1}, silent, step);
    enough = result.stop != StopReason::TooFewPairs;
  }
  if (enough) {
    iterate(result, {options.max_iterations, options.tolerance, options.tolerance * target.diagonal},
            context.phase(0.5, 1.0, "softicp"), step);
  }
  context.report(1.0);
  return result;
}

}  // namespace shapelight
