#pragma once

#include <nanobind/nanobind.h>

#include "shapelight/pipeline/register.hpp"

namespace shapelight::python {

[[nodiscard]] nanobind::dict to_dict(const RegistrationResult& result);
[[nodiscard]] nanobind::dict to_dict(const PoseAssessment& pose);
[[nodiscard]] nanobind::dict to_dict(const RegisterResult& result);

}  // namespace shapelight::python
