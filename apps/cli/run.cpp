#include "run.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "shapelight/core/error.hpp"
#include "values.hpp"

namespace shapelight::cli {
namespace {

CameraIntrinsics parse_intrinsics(const std::string& text) {
  constexpr std::string_view kExpected = "fx,fy,cx,cy in pixels";
  std::vector<double> values;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    values.push_back(parse_number("intrinsics", std::string_view(text).substr(begin, end - begin), kExpected));
    begin = end + 1;
  }
  if (values.size() != 4 || values[0] <= 0.0 || values[1] <= 0.0) {
    throw InvalidInput(fmt::format("--intrinsics: '{}', expected {}", text, kExpected));
  }
  return {values[0], values[1], values[2], values[3]};
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored) ||
         std::filesystem::absolute(a).lexically_normal() == std::filesystem::absolute(b).lexically_normal();
}

}  // namespace

void add_common_options(CLI::App& command, CommonOptions& options) {
  const std::string group = "Common options";
  command.add_option("--threads", options.threads, "Threads; 0: all cores. Never changes a result. (0)")
      ->group(group)
      ->check(CLI::Range(0, 4096));
  command.add_option("--max-memory", options.max_memory, "Refuse the run when its estimate is larger, e.g. 2G.")
      ->group(group);
  command.add_option("--json", options.json, "Write the run's report to FILE, or to stdout with '-'.")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--progress", options.progress, "Progress on stderr: auto, always, never or json. (auto)")
      ->check(CLI::IsMember({"auto", "always", "never", "json"}))
      ->group(group);
  command.add_flag("-q,--quiet", options.quiet, "No words but errors.")->group(group);
  command.add_flag("-v,--verbose", options.verbose, "More words: seconds per phase, memory.")->group(group);
  command.add_flag("--force", options.force, "Overwrite existing files.")->group(group);
  command.add_flag("--dry-run", options.dry_run, "Do everything but write.")->group(group);
  command.add_option("--intrinsics", options.intrinsics, "Camera of a depth image: fx,fy,cx,cy [pixels].")
      ->group(group);
  command.add_option("--depth-scale", options.depth_scale, "Depth image steps per unit of length. (1000)")
      ->group(group);
}

Run::Run(std::string command, const CommonOptions& common_options, std::stop_token stop)
    : command_(std::move(command)), options_(common_options), stop_(std::move(stop)) {
  if (!options_.intrinsics.empty()) read_options_.intrinsics = parse_intrinsics(options_.intrinsics);
  if (options_.depth_scale < 0.0) throw InvalidInput("--depth-scale: expected a positive number");
  if (options_.depth_scale > 0.0) read_options_.depth_scale = options_.depth_scale;
  if (!options_.json.empty() && options_.json != "-" && !options_.force && std::filesystem::exists(options_.json)) {
    throw WriteError(fmt::format("{}: exists already, not overwritten (--force allows it)", options_.json));
  }
}

RunContext Run::context() {
  const bool as_json = options_.progress == "json";
  const bool shown = as_json || options_.progress == "always" ||
                     (options_.progress == "auto" && !options_.quiet && isatty(STDERR_FILENO) != 0);
  RunContext context{options_.threads, stop_, {}};
  context.progress = [this, as_json, shown, last = -1](double fraction, std::string_view phase) mutable {
    enter_phase(phase);
    const int percent = static_cast<int>(100.0 * fraction);
    if (!shown || percent <= last) return;
    last = percent;
    if (as_json) {
      fmt::print(stderr, "{}\n", nlohmann::ordered_json{{"fraction", fraction}, {"phase", phase}}.dump());
    } else {
      fmt::print(stderr, "\r\033[K{:3d} %  {}", percent, phase);
      if (percent >= 100) fmt::print(stderr, "\r\033[K");
      std::fflush(stderr);
    }
  };
  return context;
}

void Run::enter_phase(std::string_view phase) {
  if (phase == phase_) return;
  const auto now = std::chrono::steady_clock::now();
  if (!phase_.empty()) add_seconds(phase_, std::chrono::duration<double>(now - phase_start_).count());
  phase_ = phase;
  phase_start_ = now;
}

void Run::add_seconds(const std::string& name, double seconds) {
  const double before = seconds_.contains(name) ? seconds_[name].get<double>() : 0.0;
  seconds_[name] = before + seconds;
}

Geometry Run::read(const std::filesystem::path& path) {
  const Timer timer(*this, "read");
  if (!options_.max_memory.empty()) {
    std::error_code ignored;
    const auto size = std::filesystem::file_size(path, ignored);
    if (!ignored) check_memory(size);
  }
  Geometry geometry = read_geometry(path, read_options_, RunContext{options_.threads, stop_, {}});
  for (const std::string& warning : geometry.warnings) warn(fmt::format("{}: {}", path.string(), warning));
  inputs_.push_back({{"path", path.string()},
                     {"format", geometry.format},
                     {"vertices", geometry.size()},
                     {"faces", geometry.triangles.size()},
                     {"kind", geometry_kind_name(geometry.kind())}});
  input_paths_.push_back(path);
  check_report(path);
  return geometry;
}

void Run::check_output(const std::filesystem::path& path, bool is_geometry) const {
  if (is_geometry) check_writable_format(path);
  for (const auto& input : input_paths_) {
    if (same_file(input, path))
      throw WriteError(fmt::format("{}: is the input, which is never overwritten", path.string()));
  }
  if (!options_.force && std::filesystem::exists(path)) {
    throw WriteError(fmt::format("{}: exists already, not overwritten (--force allows it)", path.string()));
  }
  check_report(path);
}

void Run::check_report(const std::filesystem::path& path) const {
  if (options_.json.empty() || options_.json == "-" || !same_file(options_.json, path)) return;
  throw WriteError(fmt::format("{}: the report would replace the input or the output", options_.json));
}

void Run::write(const std::filesystem::path& path, const Geometry& geometry, bool ascii) {
  if (options_.dry_run) return;
  check_output(path);
  const Timer timer(*this, "write");
  const std::vector<std::string> dropped = write_geometry(path, geometry, {.ascii = ascii, .overwrite = options_.force},
                                                          RunContext{options_.threads, stop_, {}});
  for (const Column& column : geometry.attributes.columns()) {
    if (std::find(dropped.begin(), dropped.end(), column.name) == dropped.end()) attributes_kept.push_back(column.name);
  }
  for (const std::string& name : dropped) {
    warn(fmt::format("{}: the format cannot hold '{}', left out", path.string(), name));
    attributes_dropped.push_back(name);
  }
}

void Run::check_memory(std::uint64_t bytes) const {
  if (options_.max_memory.empty()) return;
  const std::uint64_t limit = parse_bytes("max-memory", options_.max_memory);
  if (bytes > limit) {
    throw BudgetExceeded(
        fmt::format("the run needs about {} MiB, more than --max-memory {} allows", bytes >> 20, options_.max_memory));
  }
}

void Run::warn(const std::string& message) {
  warnings_.push_back(message);
  if (!options_.quiet) fmt::print(stderr, "warning: {}\n", message);
}

void Run::warn(const GraphDiagnostics& counts) {
  const auto note = [&](std::size_t count, std::string_view what) {
    if (count > 0) warn(fmt::format("{} {}", count, what));
  };
  note(counts.non_finite_points, "points without a finite position: never chosen");
  note(counts.duplicate_points, "points at the place of another one: chosen last");
  note(counts.isolated_vertices, "points without a neighbour: never chosen for detail");
  note(counts.outliers, "points flagged as strays: chosen last");
  note(counts.degenerate_triangles, "triangles with a repeated vertex or no area: ignored");
  note(counts.non_manifold_edges, "edges of more than two triangles");
}

void Run::say(const std::string& line) const {
  if (!options_.quiet) fmt::print(stderr, "{}\n", line);
}

nlohmann::ordered_json Run::report() const {
  nlohmann::ordered_json report;
  report["schema"] = "shapelight.report/1";
  report["command"] = command_;
  report["version"] = SHAPELIGHT_VERSION;
  report["input"] = inputs_.size() == 1 ? inputs_.front() : inputs_;
  report["options"] = options;
  report["options"]["threads"] = options_.threads;
  if (points_in) report["counts"]["in"] = *points_in;
  if (points_out) report["counts"]["out"] = *points_out;
  report["seconds"] = seconds_;
  report["seconds"]["total"] = seconds_since(start_);
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["attributes"] = {{"kept", attributes_kept}, {"dropped", attributes_dropped}};
  report["warnings"] = warnings_;
  report["result"] = result;
  return report;
}

void Run::finish() {
  const nlohmann::ordered_json whole = report();
  if (options_.verbose && !options_.quiet) {
    for (const auto& [phase, seconds] : whole["seconds"].items()) {
      fmt::print(stderr, "{:>10.3f} s  {}\n", seconds.get<double>(), phase);
    }
    fmt::print(stderr, "{:>8} MiB  peak memory\n", whole["peak_memory_bytes"].get<std::uint64_t>() >> 20);
  }
  if (options_.json.empty()) return;
  const std::string text = whole.dump(2) + "\n";
  if (options_.json == "-") {
    fmt::print("{}", text);
    return;
  }
  const std::string temporary = options_.json + ".part";
  std::ofstream file(temporary, std::ios::binary);
  file << text;
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(temporary, options_.json, error);
  if (!file || error) {
    std::filesystem::remove(temporary, error);
    throw WriteError(fmt::format("{}: cannot write the report", options_.json));
  }
}

Run::Timer::~Timer() {
  run_.enter_phase({});
  run_.add_seconds(name_, seconds_since(start_));
}

}  // namespace shapelight::cli
