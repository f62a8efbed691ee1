#include "core/parallel.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <optional>

namespace shapelight::parallel {
namespace {

// Where there are fewer cores. TBB ends the process when the system refuses it a thread.
constexpr int kMostThreads = 64;

}  // namespace

void run_chunks(const RunContext& context, std::size_t num_chunks, const std::function<void(std::size_t)>& body) {
  context.check();
  if (num_chunks <= 1 || context.max_threads == 1) {
    for (std::size_t i = 0; i < num_chunks; ++i) {
      context.check();
      body(i);
    }
    return;
  }
  std::atomic<bool> stopped{false};
  const int cores = tbb::info::default_concurrency();
  const int threads = std::min(context.max_threads, std::max(cores, kMostThreads));
  // More threads than cores are granted only under a control of their own; TBB complains on stderr otherwise.
  std::optional<tbb::global_control> more_than_cores;
  if (threads > cores) more_than_cores.emplace(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, num_chunks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            if (stopped.load(std::memory_order_relaxed)) return;
            if (context.stop.stop_requested()) {
              stopped.store(true, std::memory_order_relaxed);
              return;
            }
            body(i);
          }
        },
        tbb::simple_partitioner());
  });
  context.check();
}

}  // namespace shapelight::parallel
