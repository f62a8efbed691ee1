#include "shapelight/core/options.hpp"

#include <fmt/format.h>

#include "shapelight/core/error.hpp"

namespace shapelight {

void check_range(const OptionInfo& info, double value) {
  // The negated form also refuses NaN.
  if (!(value >= info.min && value <= info.max)) {
    throw InvalidInput(fmt::format("--{}: {:g} is out of range, expected {:g} .. {:g} [{}]", info.name, value, info.min,
                                   info.max, info.unit));
  }
}

}  // namespace shapelight
