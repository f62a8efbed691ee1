#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/graph/surface_graph.hpp"
#include "shapelight/io/io.hpp"

namespace shapelight::cli {

/// Options that every command has.
struct CommonOptions {
  int threads = 0;
  std::string max_memory;
  std::string json;
  std::string progress = "auto";
  bool quiet = false;
  bool verbose = false;
  bool force = false;
  bool dry_run = false;
  std::string intrinsics;
  double depth_scale = 0.0;
};
void add_common_options(CLI::App& command, CommonOptions& options);

/// One run of a command: reads, writes, times, reports. Words go to stderr; stdout carries data and `--json -`.
class Run {
 public:
  Run(std::string command, const CommonOptions& options, std::stop_token stop);

  [[nodiscard]] RunContext context();
  /// Reads a file and notes it as the input. Warnings met are noted too.
  Geometry read(const std::filesystem::path& path);
  /// Throws unless the path can be written: known format, not an input, not there already (or --force).
  void check_output(const std::filesystem::path& path, bool is_geometry = true) const;
  /// Writes unless --dry-run; notes attributes that the format cannot hold.
  void write(const std::filesystem::path& path, const Geometry& geometry, bool ascii = false);
  /// Throws BudgetExceeded when --max-memory is below `bytes`.
  void check_memory(std::uint64_t bytes) const;
  /// Runs work and adds its time to the report under `name`; the library's phases within are added by themselves.
  template <class Work>
  auto timed(const std::string& name, Work&& work) {
    const Timer timer(*this, name);
    return work();
  }
  /// The report as it stands.
  [[nodiscard]] nlohmann::ordered_json report() const;
  void warn(const std::string& message);
  /// Odd but usable input, one warning each.
  void warn(const GraphDiagnostics& counts);
  /// One line for people, unless --quiet.
  void say(const std::string& line) const;
  /// Writes the JSON report where asked. Call once, at the end.
  void finish();

  [[nodiscard]] const CommonOptions& common() const { return options_; }
  nlohmann::ordered_json options = nlohmann::ordered_json::object();  ///< as resolved; goes into the report
  nlohmann::ordered_json result = nlohmann::ordered_json::object();   ///< of the command
  std::optional<std::uint64_t> points_in;   ///< counts.in
  std::optional<std::uint64_t> points_out;  ///< counts.out
  std::vector<std::string> attributes_kept;
  std::vector<std::string> attributes_dropped;

 private:
  class Timer {
   public:
    Timer(Run& run, std::string name) : run_(run), name_(std::move(name)), start_(std::chrono::steady_clock::now()) {}
    ~Timer();

   private:
    Run& run_;
    std::string name_;
    std::chrono::steady_clock::time_point start_;
  };

  // Throws when the JSON report would be written onto this file.
  void check_report(const std::filesystem::path& path) const;
  void enter_phase(std::string_view phase);
  void add_seconds(const std::string& name, double seconds);

  std::string command_;
  CommonOptions options_;
  std::stop_token stop_;
  ReadOptions read_options_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  nlohmann::ordered_json inputs_ = nlohmann::ordered_json::array();
  std::vector<std::filesystem::path> input_paths_;
  nlohmann::ordered_json seconds_;
  std::vector<std::string> warnings_;
  std::string phase_;  // of the library, as its progress names it
  std::chrono::steady_clock::time_point phase_start_;
};

}  // namespace shapelight::cli
