#include <fmt/format.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <new>
#include <stop_token>
#include <thread>
#include <vector>

#include "commands.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::cli {
namespace {

constexpr int kInternalError = 1;
constexpr int kBadUsage = 2;
constexpr int kMemoryExceeded = 7;
constexpr int kInterrupted = 130;
constexpr int kTerminated = 143;

std::atomic<int> received_signal{0};

// Waits for Ctrl-C and termination on a thread of its own and turns them into a stop request, so that every file in
// the making is removed on the way out. A second one ends the process at once.
void watch_signals(std::stop_source& stop) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // inherited by all threads that start later
  std::thread([signals, &stop] {
    int signal = 0;
    sigwait(&signals, &signal);
    received_signal = signal;
    stop.request_stop();
    sigwait(&signals, &signal);
    std::_Exit(signal == SIGTERM ? kTerminated : kInterrupted);
  }).detach();
}

int fail(int code, const std::string& message) {
  fmt::print(stderr, "shapelight: {}\n", message);
  return code;
}

int run(const Work& work, std::stop_token stop) {
  try {
    return work(std::move(stop));
  } catch (const Cancelled&) {
    return fail(received_signal == SIGTERM ? kTerminated : kInterrupted, "stopped, nothing was written");
  } catch (const Error& error) {
    return fail(error.exit_code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(kMemoryExceeded, "out of memory");
  } catch (const std::exception& error) {
    return fail(kInternalError, fmt::format("internal error, please report: {}", error.what()));
  }
}

int main(int argc, char** argv) {
  static std::stop_source stop;  // outlives the thread that watches signals
  watch_signals(stop);
  CLI::App app("shapelight keeps the points that carry a shape.", "shapelight");
  app.set_version_flag("--version", std::string("shapelight ") + SHAPELIGHT_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(42);
  const std::vector<Command> commands = {add_sample_command(app),   add_fields_command(app), add_simplify_command(app),
                                         add_register_command(app), add_align_command(app),  add_metrics_command(app),
                                         add_render_command(app),   add_scan_command(app),   add_info_command(app),
                                         add_convert_command(app),  add_formats_command(app)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : (app.exit(error), kBadUsage);
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return run(command.work, stop.get_token());
  }
  return kBadUsage;
}

}  // namespace
}  // namespace shapelight::cli

int main(int argc, char** argv) { return shapelight::cli::main(argc, argv); }
