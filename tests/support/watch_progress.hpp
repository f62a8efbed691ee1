#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "shapelight/core/error.hpp"
#include "shapelight/core/run_context.hpp"

/// Runs work under a watched context.
namespace shapelight::testing {

using Work = std::function<void(const RunContext&)>;

struct Seen {
  std::vector<double> fractions;
  std::vector<std::string> phases;
};

inline Seen watch(const Work& work) {
  Seen seen;
  RunContext context;
  context.progress = [&](double fraction, std::string_view phase) {
    seen.fractions.push_back(fraction);
    seen.phases.emplace_back(phase);
  };
  work(context);
  return seen;
}

inline void expect_monotone_to_one(const Seen& seen) {
  ASSERT_FALSE(seen.fractions.empty());
  for (std::size_t i = 1; i < seen.fractions.size(); ++i) {
    EXPECT_GE(seen.fractions[i], seen.fractions[i - 1]) << seen.phases[i - 1] << " -> " << seen.phases[i];
  }
  EXPECT_GE(seen.fractions.front(), 0.0);
  EXPECT_EQ(seen.fractions.back(), 1.0);
}

/// Asks for a stop at each call of the progress function in turn, or at every `step`-th; only one that comes with the
/// fraction 1 may be too late.
inline void expect_cancel_everywhere(const Work& work, std::size_t step = 1) {
  const std::size_t num_calls = watch(work).fractions.size();
  for (std::size_t at = 0; at + 1 < num_calls; at += step) {
    std::stop_source stop;
    RunContext context;
    context.stop = stop.get_token();
    std::size_t call = 0;
    std::string phase;
    double fraction = 0.0;
    context.progress = [&](double f, std::string_view p) {
      if (call++ == at) {
        phase = p;
        fraction = f;
        stop.request_stop();
      }
    };
    try {
      work(context);
      EXPECT_EQ(fraction, 1.0) << "call " << at << " of " << num_calls << ", " << phase << ": ran to its end";
    } catch (const Cancelled&) {
    }
  }
}

}  // namespace shapelight::testing
