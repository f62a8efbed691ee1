#include "run.hpp"

#include <fmt/format.h>
#include <nanobind/stl/string.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bindings.hpp"
#include "shapelight/core/error.hpp"

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

// Calls under way. Python ends daemon threads at the point where they next take the GIL, which no C++ frame survives:
// before it does so, every call is stopped and waited for.
class Calls {
 public:
  void add(std::stop_source& call) {
    const std::lock_guard lock(mutex_);
    calls_.insert(&call);
    if (ending_ && ending_ != std::this_thread::get_id()) call.request_stop();
  }
  void remove(std::stop_source& call) {
    const std::lock_guard lock(mutex_);
    calls_.erase(&call);
    changed_.notify_all();
  }
  void stop_all() {
    const nb::gil_scoped_release release;
    std::unique_lock lock(mutex_);
    ending_ = std::this_thread::get_id();
    for (std::stop_source* call : calls_) call->request_stop();
    changed_.wait(lock, [&] { return calls_.empty(); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::stop_source*> calls_;
  std::optional<std::thread::id> ending_;  // the thread that ends Python: it may go on calling
};

Calls& calls() {
  static Calls under_way;
  return under_way;
}

// The thread that works. At the end of its scope it is stopped and waited for, whatever was thrown in between.
class Worker {
 public:
  template <class Work>
  Worker(std::stop_source& stop, Work&& work) : call_(stop), thread_(std::forward<Work>(work)) {}
  ~Worker() {
    call_.stop.request_stop();
    const nb::gil_scoped_release release;
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

 private:
  struct Call {
    std::stop_source& stop;
    explicit Call(std::stop_source& source) : stop(source) { calls().add(stop); }
    ~Call() { calls().remove(stop); }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;
  } call_;
  std::thread thread_;
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

void work_and_tell(Exchange& exchange, const RunContext& context, const std::function<void(const RunContext&)>& work) {
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
}

// Hands progress on and looks for signals until the work is done. What a signal handler or the progress callable
// raises stops the work and is thrown when it has ended. Returns the progress reached.
double attend(Exchange& exchange, std::stop_source& stop, const nb::object& callable) {
  std::exception_ptr raised;
  double reached = 0.0;
  std::vector<std::pair<double, std::string>> progress;
  for (bool done = false; !done;) {
    done = wait_for_news(exchange, progress);
    if (raised) continue;
    try {
      for (const auto& [fraction, phase] : progress) {
        callable(fraction, phase);
        reached = fraction;
      }
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    } catch (...) {
      raised = std::current_exception();
      stop.request_stop();
    }
  }
  if (raised) std::rethrow_exception(raised);
  return reached;
}

int thread_count(const nb::object& threads) {
  int count = 0;
  if (nb::try_cast<int>(threads, count) && count >= 0) return count;
  throw InvalidInput(fmt::format("threads: {}, expected a whole number, 0 for all cores", nb::repr(threads).c_str()));
}

}  // namespace

void run_interruptibly(const CallStyle& style, const std::function<void(const RunContext&)>& work) {
  Exchange exchange;
  std::stop_source stop;
  RunContext context{.max_threads = thread_count(style.threads), .stop = stop.get_token(), .progress = {}};
  if (!style.progress.is_none()) {
    context.progress = [&exchange](double fraction, std::string_view phase) {
      const std::lock_guard lock(exchange.mutex);
      exchange.progress.emplace_back(fraction, phase);
      exchange.changed.notify_one();
    };
  }
  double reached = 0.0;
  {
    const Worker worker(stop, [&] { work_and_tell(exchange, context, work); });
    reached = attend(exchange, stop, style.progress);
  }
  if (exchange.failure) std::rethrow_exception(exchange.failure);
  // A short stage may report nothing; its bar ends full all the same.
  if (!style.progress.is_none() && reached < 1.0) style.progress(1.0, "");
}

void bind_run(nb::module_& module) {
  module.def(
      "stop_all", [] { calls().stop_all(); }, "Stops every call and waits for its end. Calls from now on stop too.");
  nb::module_::import_("atexit").attr("register")(module.attr("stop_all"));
}

}  // namespace shapelight::python
