#include "shapelight/registration/icp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "registration/closest_points.hpp"
#include "registration/iterate.hpp"
#include "registration/normal_equations.hpp"
#include "registration/rigid_fit.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kMinPoints = 3;
constexpr std::size_t kChunk = 4096;
constexpr double kGicpThickness = 1e-3;  // variance of a disc along its normal, 1 within it (Segal et al. 2009)

// (C_q + R C_p R^T)^-1 of two unit discs with normals a and b: C = I - (1 - thickness) n n^T. The sum's eigenvectors
// are a + b, a - b and a x b.
Eigen::Matrix3d gicp_matrix(const Vec3& a, const Vec3& b) {
  constexpr double kFlatness = 1.0 - kGicpThickness;
  const double cosine = a.dot(b);
  const Vec3 sum = a + b;
  const Vec3 difference = a - b;
  return 0.5 * Eigen::Matrix3d::Identity() +
         (0.25 * kFlatness / (2.0 - kFlatness * (1.0 + cosine))) * (sum * sum.transpose()) +
         (0.25 * kFlatness / (2.0 - kFlatness * (1.0 - cosine))) * (difference * difference.transpose());
}

// Sums over the pairs; `Equations` is RigidFit or NormalEquations.
template <class Equations>
struct PairSums {
  Equations equations;
  std::size_t pairs = 0;
  double distance_sq = 0.0;
};

// add(equations, i, match) -> bool takes the pair of source point i in, or not.
template <class Equations, class Add>
PairSums<Equations> sum_pairs(const ClosestPoints& closest, const Equations& zero, const RunContext& context,
                              Add&& add) {
  return parallel::reduce_chunks(
      context, closest.size(), PairSums<Equations>{zero},
      [&](std::size_t begin, std::size_t end) {
        PairSums<Equations> part{zero};
        for (std::size_t i = begin; i < end; ++i) {
          const Neighbor& match = closest.match(i);
          if (match.index == kNoIndex || !add(part.equations, i, match)) continue;
          ++part.pairs;
          part.distance_sq += match.distance_sq;
        }
        return part;
      },
      [](PairSums<Equations> a, const PairSums<Equations>& b) {
        a.equations += b.equations;
        a.pairs += b.pairs;
        a.distance_sq += b.distance_sq;
        return a;
      },
      kChunk);
}

// All but the motion.
template <class Equations>
std::optional<IterationStep> make_step(const PairSums<Equations>& sums, double cost, std::size_t num_points) {
  if (sums.pairs < kMinPoints) return std::nullopt;
  const auto pairs = static_cast<double>(sums.pairs);
  return IterationStep{.error = std::sqrt(std::max(cost, 0.0) / pairs),
                       .inlier_ratio = pairs / static_cast<double>(num_points),
                       .rms = std::sqrt(sums.distance_sq / pairs)};
}

// Gauss-Newton steps that come to rest. At the end a few pairs may change back and forth for ever, and the pose with
// them: steps below the spacing that turn back without becoming much smaller are shortened more and more.
class StepControl {
 public:
  using Step = NormalEquations::Vector6;
  explicit StepControl(double spacing) : spacing_(spacing) {}

  Step shorten(const Step& step) {
    const double length = step.norm();
    if (step.dot(last_) < 0.0 && length < spacing_ && length > 0.5 * last_.norm()) share_ *= 0.5;
    last_ = step;
    return share_ * step;
  }

 private:
  double spacing_;
  double share_ = 1.0;
  Step last_ = Step::Zero();
};

void check_normals(const RegistrationCloud& cloud, std::string_view which, IcpMetric metric) {
  if (cloud.normal.empty()) {
    throw InvalidInput(
        fmt::format("registration: metric {} needs the normals of the {} points", enum_name(metric), which));
  }
}

}  // namespace

RegistrationResult register_by_icp(const RegistrationCloud& source, const RegistrationCloud& target,
                                   const RigidTransform& T_target_source, const IcpOptions& options,
                                   const RunContext& context) {
  validate_options(options);
  check_registration_input(source, target, T_target_source, kMinPoints);
  if (options.metric != IcpMetric::Point) check_normals(target, "target", options.metric);
  if (options.metric == IcpMetric::Gicp) check_normals(source, "source", options.metric);

  const double max_distance = options.max_distance > 0.0 ? options.max_distance : 0.1 * target.diagonal;
  ClosestPoints closest(source.position, target);

  const auto point_step = [&](const RigidTransform& T) {
    const bool changed = closest.update(T, context, max_distance);
    const auto sums = sum_pairs(closest, RigidFit(T.translation()), context,
                                [&](RigidFit& fit, std::size_t i, const Neighbor& match) {
                                  fit.add(closest.moved(i), closest.target(match));
                                  return true;
                                });
    std::optional<IterationStep> step = make_step(sums, sums.distance_sq, source.size());
    if (!step) return step;
    step->motion = sums.equations.solve();
    step->fixed_point = !changed;
    return step;
  };
  StepControl control(target.spacing);
  const auto surface_step = [&](const RigidTransform& T) {
    closest.update(T, context, max_distance);
    const NormalEquations zero(T.translation(), source.diagonal > 0.0 ? source.diagonal : 1.0);
    const auto sums =
        sum_pairs(closest, zero, context, [&](NormalEquations& equations, std::size_t i, const Neighbor& match) {
          const Vec3& normal = target.normal[match.index];
          if (normal.isZero()) return false;
          const Vec3& x = closest.moved(i);
          const Vec3 r = x - closest.target(match);
          if (options.metric == IcpMetric::Plane) {
            equations.add_plane(x, r, normal);
            return true;
          }
          if (source.normal[i].isZero()) return false;
          equations.add_matrix(x, r, gicp_matrix(normal, T.linear() * source.normal[i]));
          return true;
        });
    std::optional<IterationStep> step = make_step(sums, sums.equations.cost(), source.size());
    if (!step) return step;
    step->motion = sums.equations.to_motion(control.shorten(sums.equations.solve()));
    return step;
  };

  RegistrationResult result;
  result.T_target_source = T_target_source;
  const IterationLimits limits{options.max_iterations, options.rotation_tolerance,
                               options.translation_tolerance * target.diagonal};
  if (options.metric == IcpMetric::Point) {
    iterate(result, limits, context, point_step);
  } else {
    iterate(result, limits, context, surface_step);
  }
  context.report(1.0);
  return result;
}

}  // namespace shapelight
