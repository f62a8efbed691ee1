#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <stop_token>

namespace shapelight::cli {

/// Adds a subcommand and returns the work to do when it was chosen; the work's result is the exit code.
using Work = std::function<int(std::stop_token)>;
struct Command {
  CLI::App* app;
  Work work;
};

Command add_sample_command(CLI::App& app);
Command add_fields_command(CLI::App& app);
Command add_simplify_command(CLI::App& app);
Command add_register_command(CLI::App& app);
Command add_align_command(CLI::App& app);
Command add_scan_command(CLI::App& app);
Command add_metrics_command(CLI::App& app);
Command add_info_command(CLI::App& app);
Command add_convert_command(CLI::App& app);
Command add_formats_command(CLI::App& app);
Command add_render_command(CLI::App& app);

}  // namespace shapelight::cli
