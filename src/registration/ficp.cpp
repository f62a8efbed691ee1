#include "shapelight/registration/ficp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.hpp"
#include "registration/closest_points.hpp"
#include "registration/iterate.hpp"
#include "registration/rigid_fit.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kMinPairs = 10;
constexpr std::size_t kChunk = 4096;
// [diagonals] added to every residual, so that pairs which coincide up to rounding do not outdo each other and all
// count.
constexpr double kResidualFloor = 1e-12;

// The k closest pairs, k being best for the fractional error.
class FractionalSet {
 public:
  FractionalSet(std::size_t num_points, const FicpOptions& options, double floor_sq)
      : floor_sq_(floor_sq), order_(num_points), weight_(num_points + 1) {
    for (std::size_t i = 0; i < num_points; ++i) order_[i].index = static_cast<Index>(i);
    const auto n = static_cast<double>(num_points);
    max_count_ = std::max(kMinPairs, static_cast<std::size_t>(options.max_fraction * n));
    min_count_ = std::clamp(static_cast<std::size_t>(std::ceil(options.min_fraction * n)), kMinPairs, max_count_);
  }

  void set_lambda(double lambda) {
    const auto n = static_cast<double>(order_.size());
    for (std::size_t k = min_count_; k <= max_count_; ++k) {
      const auto count = static_cast<double>(k);
      weight_[k] = std::pow(n / count, 2.0 * lambda) / count;
    }
  }

  // FRMSD^2 = f^(-2 lambda) / k * sum of the k smallest squared distances; of equal ones the largest k.
  void choose(const ClosestPoints& closest) {
    // From the order of the iteration before, which is nearly the new one and sorted in less time.
    for (Neighbor& pair : order_) pair.distance_sq = closest.match(pair.index).distance_sq;
    std::sort(order_.begin(), order_.end());
    double sum = 0.0;
    frmsd_sq_ = HUGE_VAL;
    for (std::size_t k = 1; k <= max_count_; ++k) {
      sum += order_[k - 1].distance_sq + floor_sq_;
      if (k < min_count_ || sum * weight_[k] > frmsd_sq_) continue;
      frmsd_sq_ = sum * weight_[k];
      sum_sq_ = sum;
      count_ = k;
    }
    last_ = order_[count_ - 1];
  }

  [[nodiscard]] bool contains(double distance_sq, std::size_t i) const {
    return !(last_ < Neighbor{distance_sq, static_cast<Index>(i)});
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double frmsd() const { return std::sqrt(frmsd_sq_); }
  [[nodiscard]] double rms() const { return std::sqrt(sum_sq_ / static_cast<double>(count_)); }

 private:
  double floor_sq_;
  std::size_t min_count_ = 0;
  std::size_t max_count_ = 0;
  std::vector<Neighbor> order_;  // (squared distance, source point)
  std::vector<double> weight_;   // per count: f^(-2 lambda) / count
  Neighbor last_;                // of the chosen
  std::size_t count_ = 0;
  double frmsd_sq_ = 0.0;
  double sum_sq_ = 0.0;
};

}  // namespace

RegistrationResult register_by_ficp(const RegistrationCloud& source, const RegistrationCloud& target,
                                    const RigidTransform& T_target_source, const FicpOptions& options,
                                    const RunContext& context) {
  validate_options(options);
  check_registration_input(source, target, T_target_source, kMinPairs);
  if (options.min_fraction > options.max_fraction) {
    throw InvalidInput(fmt::format("--min-fraction: {}, expected at most --max-fraction {}", options.min_fraction,
                                   options.max_fraction));
  }
  const double floor = kResidualFloor * target.diagonal;
  ClosestPoints closest(source.position, target);
  FractionalSet chosen(source.size(), options, floor * floor);
  std::vector<std::uint8_t> is_chosen(source.size(), 0);

  const auto step = [&](const RigidTransform& T) -> std::optional<IterationStep> {
    const bool matches_changed = closest.update(T, context);
    chosen.choose(closest);
    struct Sums {
      RigidFit fit;
      bool changed = false;
    };
    const Sums zero{RigidFit(T.translation())};
    const Sums sums = parallel::reduce_chunks(
        context, source.size(), zero,
        [&](std::size_t begin, std::size_t end) {
          Sums part = zero;
          for (std::size_t i = begin; i < end; ++i) {
            const Neighbor& match = closest.match(i);
            const bool now = chosen.contains(match.distance_sq, i);
            part.changed |= now != (is_chosen[i] != 0);
            is_chosen[i] = now ? 1 : 0;
            if (now) part.fit.add(closest.moved(i), closest.target(match));
          }
          return part;
        },
        [](Sums a, const Sums& b) {
          a.fit += b.fit;
          a.changed |= b.changed;
          return a;
        },
        kChunk);
    return IterationStep{.motion = sums.fit.solve(),
                         .fixed_point = !matches_changed && !sums.changed,
                         .error = chosen.frmsd(),
                         .inlier_ratio = static_cast<double>(chosen.count()) / static_cast<double>(source.size()),
                         .rms = chosen.rms()};
  };

  RegistrationResult result;
  result.T_target_source = T_target_source;
  const IterationLimits limits{options.max_iterations, options.rotation_tolerance,
                               options.translation_tolerance * target.diagonal};
  const bool annealed = options.start_lambda > options.lambda;
  if (annealed) {
    chosen.set_lambda(options.start_lambda);
    iterate(result, limits, context.phase(0.0, 0.5, "ficp, wide"), step);
  }
  chosen.set_lambda(options.lambda);
  iterate(result, limits, context.phase(annealed ? 0.5 : 0.0, 1.0, "ficp"), step);
  context.report(1.0);
  return result;
}

}  // namespace shapelight
