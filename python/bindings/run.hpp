#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <optional>

#include "shapelight/core/run_context.hpp"

namespace shapelight::python {

namespace nb = nanobind;

/// How a Python caller wants a long call to run.
struct CallStyle {
  nb::object threads = nb::int_(0);  ///< 0: all cores
  nb::object progress = nb::none();  ///< None, or a callable that takes (fraction, phase)
};

/// Runs the work on a thread of its own with the GIL released, while the caller's thread hands progress on and looks
/// for signals many times a second: Ctrl-C stops the work and raises KeyboardInterrupt. An exception of the progress
/// callable stops the work too and is raised. The work must not touch Python objects.
void run_interruptibly(const CallStyle& style, const std::function<void(const RunContext&)>& work);

template <class Work>
[[nodiscard]] auto run(const CallStyle& style, Work&& work) {
  std::optional<std::invoke_result_t<Work, const RunContext&>> result;
  run_interruptibly(style, [&](const RunContext& context) { result.emplace(work(context)); });
  return std::move(*result);
}

}  // namespace shapelight::python
