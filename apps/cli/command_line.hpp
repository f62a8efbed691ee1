#pragma once

#include <stop_token>

namespace shapelight::cli {

/// Runs the command line; argv[0] is the program's name. Returns the exit code of INTERFACE, 130 when `stop` was
/// requested. Words go to stderr, data to stdout.
int run_command_line(int argc, const char* const* argv, const std::stop_token& stop);

}  // namespace shapelight::cli
