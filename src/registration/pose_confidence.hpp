#pragma once

#include <string>

#include "shapelight/registration/pose_assessment.hpp"

namespace shapelight::registration {

/// What the confidence is made of.
struct Judgement {
  double confidence = 0.0;  ///< [1] calibrated share of right poses among poses that look like this one
  std::string doubt;        ///< what speaks most against the pose; empty when nothing does
};

/// Logistic regression over the measures of an assessment, shared with rivals, and void when some motion is free;
/// fitted to registrations of known truth by bench/registration/calibrate.py.
[[nodiscard]] Judgement judge_pose(const PoseAssessment& pose);

}  // namespace shapelight::registration
