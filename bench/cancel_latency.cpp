// How long a stop takes: for every job of the library, stops are requested at moments spread over the run, from
// another thread, and the time from the request to the return is measured, with all that has to be freed.
//
//   cancel_latency MESH [--points N] [--stops N] [--threads N] [--only TEXT]
//
// The mesh is cut until it has N vertices (default 1000000). Prints Markdown. With one thread (the default) the time is
// the CPU time of the thread that works, which other programs do not disturb; with more it is wall time. --stops 0
// runs every job once to its end.

#include <fmt/format.h>
#include <time.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "cancel_jobs.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/io/io.hpp"

namespace {

using namespace shapelight;

struct Arguments {
  std::string mesh;
  std::size_t points = 1'000'000;
  int stops = 24;
  int threads = 1;
  std::string only;
};

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The clock of what is waited for: of the calling thread when it works alone.
clockid_t own_clock(int threads) {
  clockid_t clock = CLOCK_MONOTONIC;
  if (threads == 1) pthread_getcpuclockid(pthread_self(), &clock);
  return clock;
}

struct Run {
  double total = 0.0;    ///< [s] from start to return
  double latency = 0.0;  ///< [s] from request to return; 0: it returned before
  std::string phase;     ///< when the stop was requested
};

// Runs the job on this thread while another one requests a stop `after` seconds; never when it is negative.
Run run_until(const bench::Job& job, double after, int threads) {
  const clockid_t clock = own_clock(threads);
  const double start = seconds(clock);
  std::mutex mutex;
  std::string phase = "start";
  double requested = 0.0;
  bool over = false;
  Run run;
  std::stop_source stop;
  std::jthread requester;
  if (after >= 0.0) {
    requester = std::jthread([&] {
      for (;; std::this_thread::sleep_for(std::chrono::microseconds(500))) {
        const std::lock_guard lock(mutex);
        if (over) return;
        const double now = seconds(clock);
        if (now - start < after) continue;
        requested = now;
        run.phase = phase;
        stop.request_stop();
        return;
      }
    });
  }
  RunContext context{threads, stop.get_token(), [&](double, std::string_view name) {
                       const std::lock_guard lock(mutex);
                       if (phase != name) phase = name;
                     }};
  try {
    job.work(context);
  } catch (const Cancelled&) {
  }
  const double end = seconds(clock);
  const std::lock_guard lock(mutex);
  over = true;
  run.total = end - start;
  if (requested > 0.0) run.latency = end - requested;
  return run;
}

void measure(const bench::Job& job, const Arguments& arguments) {
  const double total = run_until(job, -1.0, arguments.threads).total;
  Run worst;
  for (int i = 0; i < arguments.stops; ++i) {
    const double golden = std::fmod(0.618033988749895 * (i + 0.5), 1.0);  // one in each stretch of the run, unevenly
    const Run run = run_until(job, total * (i + golden) / arguments.stops, arguments.threads);
    if (run.latency > worst.latency) worst = run;
  }
  fmt::print("| {} | {:.2f} | {:.0f} | {} |\n", job.name, total, 1e3 * worst.latency, worst.phase);
  std::fflush(stdout);
}

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const auto value = [&]() -> const char* { return i + 1 < argc ? argv[++i] : ""; };
    if (word == "--points") {
      arguments.points = std::strtoull(value(), nullptr, 10);
    } else if (word == "--stops") {
      arguments.stops = std::atoi(value());
    } else if (word == "--threads") {
      arguments.threads = std::atoi(value());
    } else if (word == "--only") {
      arguments.only = value();
    } else {
      arguments.mesh = word;
    }
  }
  return arguments;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  if (arguments.mesh.empty()) {
    fmt::print(stderr, "usage: cancel_latency MESH [--points N] [--stops N] [--threads N] [--only TEXT]\n");
    return 2;
  }
  const auto folder = std::filesystem::temp_directory_path() / "shapelight-cancel-latency";
  try {
    std::filesystem::create_directories(folder);
    const bench::JobInput input = bench::make_input(read_geometry(arguments.mesh), arguments.points, folder);
    fmt::print("{} vertices, {} stops a job, {} thread(s)\n\n", input.mesh.size(), arguments.stops, arguments.threads);
    fmt::print("| job | s | largest latency, ms | in |\n| --- | ---: | ---: | --- |\n");
    for (const bench::Job& job : bench::all_jobs(input)) {
      if (job.name.find(arguments.only) != std::string::npos) measure(job, arguments);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "cancel_latency: {}\n", error.what());
    return 1;
  }
  std::filesystem::remove_all(folder);
  return 0;
}
