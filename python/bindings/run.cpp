#include "run.hpp"

#include <nanobind/stl/string.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace shapelight::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{20};  // for signals: well below what people notice

// What the two threads share.
struct Exchange {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  std::exception_ptr failure;
  std::vector<std::pair<double, std::string>> progress;  // not yet handed on
};

// Waits for news without the GIL. Returns whether the work is done.
bool wait_for_news(Exchange& exchange, std::vector<std::pair<double, std::string>>& progress) {
  const nb::gil_scoped_release release;
  std::unique_lock lock(exchange.mutex);
  exchange.changed.wait_for(lock, kBetweenLooks, [&] { return exchange.done || !exchange.progress.empty(); });
  progress = std::move(exchange.progress);
  exchange.progress.clear();
  return exchange.done;
}

std::thread start(Exchange& exchange, const RunContext& context, const std::function<void(const RunContext&)>& work) {
  return std::thread([&exchange, context, &work] {
    std::exception_ptr failure;
    try {
      work(context);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(exchange.mutex);
    exchange.failure = failure;
    exchange.done = true;
    exchange.changed.notify_one();
  });
}

}  // namespace

void run_interruptibly(const CallStyle& style, const std::function<void(const RunContext&)>& work) {
  Exchange exchange;
  std::stop_source stop;
  RunContext context{.max_threads = style.threads, .stop = stop.get_token(), .progress = {}};
  if (!style.progress.is_none()) {
    context.progress = [&exchange](double fraction, std::string_view phase) {
      const std::lock_guard lock(exchange.mutex);
      exchange.progress.emplace_back(fraction, phase);
      exchange.changed.notify_one();
    };
  }
  std::thread worker = start(exchange, context, work);
  std::optional<nb::python_error> raised;  // by a signal handler or the progress callable
  std::vector<std::pair<double, std::string>> progress;
  double reached = 0.0;
  for (bool done = false; !done;) {
    done = wait_for_news(exchange, progress);
    if (raised) continue;
    try {
      for (const auto& [fraction, phase] : progress) {
        style.progress(fraction, phase);
        reached = fraction;
      }
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    } catch (nb::python_error& error) {
      raised.emplace(std::move(error));
      stop.request_stop();
    }
  }
  {
    const nb::gil_scoped_release release;
    worker.join();
  }
  if (raised) throw std::move(*raised);
  if (exchange.failure) std::rethrow_exception(exchange.failure);
  // A short stage may report nothing; its bar ends full all the same.
  if (!style.progress.is_none() && reached < 1.0) style.progress(1.0, "");
}

}  // namespace shapelight::python
