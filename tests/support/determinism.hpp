#pragma once

#include <gtest/gtest.h>

#include "shapelight/core/run_context.hpp"

namespace shapelight::testing {

/// compute(context) must give equal results, bit for bit, for 1, 2, 3 and 8 threads.
template <class Compute>
void expect_same_for_any_number_of_threads(Compute&& compute) {
  RunContext context;
  context.max_threads = 1;
  const auto expected = compute(context);
  for (const int threads : {2, 3, 8}) {
    context.max_threads = threads;
    EXPECT_EQ(compute(context), expected) << threads << " threads";
  }
}

}  // namespace shapelight::testing
