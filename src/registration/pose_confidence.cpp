#include "registration/pose_confidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace shapelight::registration {
namespace {

// One measure of a pose: its weight in the regression, and the value that right poses usually have.
struct Measure {
  double weight;
  double usual;
  double value;
  std::string doubt;

  [[nodiscard]] double against() const { return weight * (usual - value); }
};

constexpr double kConstant = 2.344;
constexpr double kRivalPower = 6.0;  // poses that fit alike share the probability

// In the order of calibrate.py, which computes the same values and prints weights and usual values.
std::array<Measure, 6> measures_of(const PoseAssessment& pose) {
  const double residual_share = pose.gate > 0.0 ? pose.residual / pose.gate : 1.0;
  return {{
      {0.267, -0.4, std::log(std::max(pose.overlap, 1e-3)),
       fmt::format("the scans overlap by {:.0f} % only", 100.0 * pose.overlap)},
      {5.461, 0.75, std::log(std::max(pose.contrast, 0.1)),
       fmt::format(
           "the surfaces do not settle on each other: they lie as far apart ({:.3g}) as surfaces that just cross",
           pose.residual)},
      {-1.364, -2.4, std::log(std::max(residual_share, 1e-3)),
       fmt::format("the surfaces lie {:.3g} apart where they meet", pose.residual)},
      {1.909, 0.9, pose.normal_agreement,
       fmt::format("the surfaces face the same way on {:.0f} % of the overlap only", 100.0 * pose.normal_agreement)},
      {-0.742, 0.005, std::min(pose.in_free_space, 0.3),
       fmt::format("{:.1f} % of the points stand where a sensor looked through", 100.0 * pose.in_free_space)},
      {1.676, std::log(1e-2), std::log(std::clamp(pose.conditioning, 1e-7, 1e-2)),
       fmt::format("the surfaces do not determine the pose: {}",
                   pose.weakest.name.empty() ? "they do not meet" : pose.weakest.name)},
  }};
}

}  // namespace

Judgement judge_pose(const PoseAssessment& pose, double rival_share) {
  const std::array<Measure, 6> measures = measures_of(pose);
  double logit = kConstant;
  for (const Measure& measure : measures) logit += measure.weight * measure.value;
  const auto worst = std::max_element(measures.begin(), measures.end(),
                                      [](const Measure& a, const Measure& b) { return a.against() < b.against(); });
  const double alone = 1.0 / (1.0 + std::exp(-logit));
  const double shared = 1.0 / (1.0 + std::pow(rival_share, kRivalPower));
  if (alone >= 0.5 && alone * shared < 0.5) {
    return {alone * shared, fmt::format("another pose fits {:.0f} % as well", 100.0 * rival_share)};
  }
  Judgement judgement{alone * shared, {}};
  if (worst->against() > 0.0) judgement.doubt = worst->doubt;
  return judgement;
}

}  // namespace shapelight::registration
