#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

std::string_view stop_reason_name(StopReason stop) {
  switch (stop) {
    case StopReason::FixedPoint:
      return "fixed point";
    case StopReason::SmallStep:
      return "small step";
    case StopReason::IterationLimit:
      return "iteration limit";
    case StopReason::TooFewPairs:
      break;
  }
  return "too few pairs";
}

}  // namespace shapelight
