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

std::string undetermined(const PoseAssessment& pose) {
  return fmt::format("the surfaces do not determine the pose: {}",
                     pose.weakest.name.empty() ? "they do not meet" : pose.weakest.name);
}

// 0 when the surfaces leave a motion free, 1 when they leave none.
double determined(const PoseAssessment& pose) {
  return std::clamp(std::log10(std::max(pose.conditioning, 1e-12)) + 4.0, 0.0, 1.0);
}

constexpr double kConstant = 2.82;

// In the order of calibrate.py, which computes the same values and prints weights and usual values.
std::array<Measure, 5> measures_of(const PoseAssessment& pose) {
  return {{
      {3.10, -0.33, std::log(std::max(pose.overlap, 1e-3)),
       fmt::format("the scans overlap by {:.0f} % only", 100.0 * pose.overlap)},
      {5.38, 0.84, std::log(std::clamp(pose.contrast, 0.1, 3.0)),
       fmt::format("the surfaces do not settle on each other: they lie {:.3g} apart, like surfaces that just cross",
                   pose.residual)},
      {1.47, -0.08, std::log(std::max(pose.normal_agreement, 0.05)),
       fmt::format("the surfaces face the same way on {:.0f} % of the overlap only", 100.0 * pose.normal_agreement)},
      {-1.55, -4.58, std::log(std::max(pose.in_free_space, 0.01)),
       fmt::format("{:.1f} % of the points stand where a sensor looked through", 100.0 * pose.in_free_space)},
      {2.00, -4.62, std::log(std::clamp(pose.conditioning, 1e-7, 1e-2)), undetermined(pose)},
  }};
}

}  // namespace

Judgement judge_pose(const PoseAssessment& pose) {
  const std::array<Measure, 5> measures = measures_of(pose);
  double logit = kConstant;
  for (const Measure& measure : measures) logit += measure.weight * measure.value;
  const auto worst = std::max_element(measures.begin(), measures.end(),
                                      [](const Measure& a, const Measure& b) { return a.against() < b.against(); });
  const double held = determined(pose) / (1.0 + std::exp(-logit));
  const double shared = 1.0 / (1.0 + pose.rival_weight);
  if (determined(pose) < 0.5) return {held * shared, undetermined(pose)};
  if (held >= 0.5 && held * shared < 0.5) {
    return {held * shared, "another pose fits nearly as well"};
  }
  Judgement judgement{held * shared, {}};
  if (worst->against() > 0.0) judgement.doubt = worst->doubt;
  return judgement;
}

}  // namespace shapelight::registration
