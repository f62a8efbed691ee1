#pragma once

#include <cstddef>

#include "shapelight/core/run_context.hpp"

namespace shapelight {

/// For long loops on one thread: context.check() at one step in 4096. `step` counts them; the others cost a
/// comparison.
inline void poll(const RunContext& context, std::size_t step) {
  if ((step & 0xfff) == 0) context.check();
}

}  // namespace shapelight
