#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace shapelight {

/// (fraction in [0, 1], phase name). Monotone, on the caller's thread, at most about a hundred calls.
using ProgressFn = std::function<void(double, std::string_view)>;

/// How to run. Nothing in it may change a result.
struct RunContext {
  int max_threads = 0;     ///< 0: all cores; 1: no pool is started
  std::stop_token stop{};  ///< polled once per chunk of work; a request ends in Cancelled
  ProgressFn progress{};   ///< empty: silent

  /// The same context for one phase of a longer job: its [0, 1] becomes [begin, end] of this one.
  /// Reports `name` at once, so that entering a phase is visible.
  [[nodiscard]] RunContext phase(double begin, double end, std::string_view name) const;

  /// Reports progress if anybody listens.
  void report(double fraction, std::string_view name = {}) const {
    if (progress) progress(fraction, name);
  }
  /// Throws Cancelled when a stop was requested.
  void check() const;
};

}  // namespace shapelight
