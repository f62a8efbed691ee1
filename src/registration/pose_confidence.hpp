#pragma once

#include <string>

#include "shapelight/registration/pose_assessment.hpp"

namespace shapelight::registration {

/// What the confidence is made of.
struct Judgement {
  double confidence = 0.0;  ///< [1] calibrated share of right poses among poses that look like this one
  std::string doubt;        ///< what speaks most against the pose; empty when nothing does
};

/// Logistic regression over the measures of an assessment and the share of its fit that another pose reaches as well;
/// fitted to registrations of known truth by bench/registration/calibrate.py.
[[nodiscard]] Judgement judge_pose(const PoseAssessment& pose, double rival_share);

}  // namespace shapelight::registration
