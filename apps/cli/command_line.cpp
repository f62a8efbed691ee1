#include "command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <vector>

#include "commands.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::cli {
namespace {

constexpr int kInternalError = 1;
constexpr int kBadUsage = 2;
constexpr int kMemoryExceeded = 7;

int fail(int code, const std::string& message) {
  fmt::print(stderr, "shapelight: {}\n", message);
  return code;
}

int run(const Work& work, const std::stop_token& stop) {
  try {
    return work(stop);
  } catch (const Cancelled& cancelled) {
    return fail(cancelled.exit_code(), "stopped, nothing was written");
  } catch (const Error& error) {
    return fail(error.exit_code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(kMemoryExceeded, "out of memory");
  } catch (const std::exception& error) {
    return fail(kInternalError, fmt::format("internal error, please report: {}", error.what()));
  }
}

}  // namespace

int run_command_line(int argc, const char* const* argv, const std::stop_token& stop) {
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
    if (command.app->parsed()) return run(command.work, stop);
  }
  return kBadUsage;
}

}  // namespace shapelight::cli
