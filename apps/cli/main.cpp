#include <signal.h>

#include <atomic>
#include <cstdlib>
#include <stop_token>
#include <thread>

#include "command_line.hpp"

namespace {

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

}  // namespace

int main(int argc, char** argv) {
  static std::stop_source stop;  // outlives the thread that watches signals
  watch_signals(stop);
  const int code = shapelight::cli::run_command_line(argc, argv, stop.get_token());
  return code == kInterrupted && received_signal == SIGTERM ? kTerminated : code;
}
