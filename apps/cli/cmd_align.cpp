#include <fmt/format.h>

#include <fstream>
#include <numbers>
#include <set>

#include "commands.hpp"
#include "described_options.hpp"
#include "matrix_json.hpp"
#include "output_folder.hpp"
#include "run.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/pipeline/align.hpp"
#include "shapelight/pipeline/memory_estimate.hpp"

namespace shapelight::cli {
namespace {

constexpr int kNotAllPlaced = 6;
constexpr double kDegrees = 180.0 / std::numbers::pi;

struct AlignArguments {
  std::vector<std::string> scans;
  std::string output, merged_spacing;
  bool no_merged = false;
  bool allow_partial = false;
  CommonOptions common;
};

// Names of the pose files: the scans' own, told apart by numbers where they are the same.
std::vector<std::string> pose_names(const std::vector<std::string>& scans) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (const std::string& scan : scans) {
    const std::string stem = std::filesystem::path(scan).stem().string();
    std::string name = stem + ".pose.txt";
    for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_{}.pose.txt", stem, i);
    names.push_back(name);
  }
  return names;
}

nlohmann::ordered_json scans_json(const AlignArguments& arguments, const std::vector<std::string>& poses,
                                  const AlignResult& result) {
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    const AlignedScan& scan = result.scans[i];
    nlohmann::ordered_json entry = {{"scan", i}, {"file", arguments.scans[i]}, {"group", scan.group}};
    entry["placed"] = scan.group == 0;
    if (scan.group == 0) entry["pose"] = poses[i];
    entry["T_world_scan"] = matrix_json(scan.T_world_scan.matrix());
    entry["residual"] = scan.rms;
    entry["partners"] = scan.partners;
    scans.push_back(std::move(entry));
  }
  return scans;
}

nlohmann::ordered_json pairs_json(const AlignResult& result) {
  nlohmann::ordered_json pairs = nlohmann::ordered_json::array();
  for (const AlignedPair& pair : result.pairs) {
    pairs.push_back({{"source", pair.source},
                     {"target", pair.target},
                     {"T_target_source", matrix_json(pair.T_target_source.matrix())},
                     {"use", enum_name(pair.graph.use)},
                     {"confidence", pair.graph.confidence},
                     {"registration_confidence", pair.registration_confidence},
                     {"overlap", pair.overlap},
                     {"closes_loop", pair.closes_loop},
                     {"loops_agree", pair.graph.loops_agree},
                     {"loops_disagree", pair.graph.loops_disagree},
                     {"rotation_off_deg", pair.graph.disagreement.rotation * kDegrees},
                     {"translation_off", pair.graph.disagreement.translation},
                     {"chi_sq", pair.graph.disagreement.chi_sq},
                     {"residual_before", pair.rms_before},
                     {"residual_after", pair.rms_after}});
  }
  return pairs;
}

void say_result(const Run& run, const AlignArguments& arguments, const AlignResult& result) {
  const auto used = std::count_if(result.pairs.begin(), result.pairs.end(),
                                  [](const AlignedPair& pair) { return pair.graph.use == EdgeUse::Used; });
  run.say(fmt::format("{} of {} scans placed; {} of {} pairs used", result.num_placed, result.scans.size(), used,
                      result.pairs.size()));
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    const AlignedScan& scan = result.scans[i];
    run.say(fmt::format("  {}: {}", arguments.scans[i],
                        scan.group != 0 ? fmt::format("not placed (group {})", scan.group)
                                        : fmt::format("{} partner{}, residual {:.4g}", scan.partners.size(),
                                                      scan.partners.size() == 1 ? "" : "s", scan.rms)));
  }
}

// Everything of a run appears at once, in the folder.
class Outputs {
 public:
  Outputs(const AlignArguments& arguments, Run& run)
      : arguments_(arguments), run_(run), pose_names_(pose_names(arguments.scans)) {
    if (!arguments.merged_spacing.empty()) (void)parse_length("merged-spacing", arguments.merged_spacing);
  }

  // Throws when one of the files may not be written.
  void check() const {
    const std::filesystem::path folder = arguments_.output;
    for (const std::string& name : pose_names_) run_.check_output(folder / name, false);
    run_.check_output(folder / "report.json", false);
    if (!arguments_.no_merged) run_.check_output(folder / "merged.ply");
  }

  void write(const std::vector<Geometry>& scans, const AlignResult& result) {
    OutputFolder folder(arguments_.output);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      if (result.scans[i].group == 0) write_transform(folder.staged(pose_names_[i]), result.scans[i].T_world_scan);
    }
    if (!arguments_.no_merged) run_.write(folder.staged("merged.ply"), merged(scans, result));
    write_report(folder.staged("report.json"));
    folder.commit();
  }

  [[nodiscard]] const std::vector<std::string>& poses() const { return pose_names_; }

 private:
  Geometry merged(const std::vector<Geometry>& scans, const AlignResult& result) {
    Geometry cloud = merge_scans(scans, result, run_.context());
    if (!arguments_.merged_spacing.empty()) {
      SampleSize size;
      size.spacing =
          parse_length("merged-spacing", arguments_.merged_spacing).resolve(bounding_box(cloud.positions).diagonal());
      SampleOptions options = sample_preset(Preset::Detail);
      options.method = SamplingMethod::Voxel;
      std::vector<Index> kept = sample(cloud, size, options, run_.context()).indices;
      std::sort(kept.begin(), kept.end());
      cloud = select_points(cloud, kept);
    }
    run_.points_out = cloud.size();
    return cloud;
  }

  void write_report(const std::filesystem::path& path) const {
    std::ofstream file(path, std::ios::binary);
    file << run_.report().dump(2) << '\n';
    file.close();
    if (!file) throw WriteError(fmt::format("{}: cannot write the report", arguments_.output));
  }

  const AlignArguments& arguments_;
  Run& run_;
  std::vector<std::string> pose_names_;
};

std::vector<Geometry> read_scans(const AlignArguments& arguments, Run& run) {
  std::vector<Geometry> scans;
  std::uint64_t points = 0;
  for (const std::string& path : arguments.scans) {
    scans.push_back(run.read(path));
    points += scans.back().size();
    run.check_memory(points * kRegisterBytesPerPoint);
  }
  run.points_in = points;
  return scans;
}

void set_report(Run& run, const AlignArguments& arguments, const AlignOptions& options, const Outputs& outputs,
                const AlignResult& result) {
  run.options = options_json(options);
  if (!arguments.merged_spacing.empty()) run.options["merged-spacing"] = arguments.merged_spacing;
  run.result = {{"placed", result.num_placed},
                {"groups", result.num_groups},
                {"chi_sq_before", result.chi_sq_before},
                {"chi_sq_after", result.chi_sq_after},
                {"scans", scans_json(arguments, outputs.poses(), result)},
                {"pairs", pairs_json(result)}};
}

// Nothing is written unless all scans are placed, or that is allowed; the report in any case.
int run_align(const AlignArguments& arguments, const DescribedFlags<AlignOptions>& flags, std::stop_token stop) {
  Run run("align", arguments.common, std::move(stop));
  if (arguments.scans.size() < 2) throw InvalidInput("one scan, expected two or more");
  AlignOptions options;
  flags.apply(options);
  validate_options(options);
  Outputs outputs(arguments, run);
  outputs.check();

  const std::vector<Geometry> scans = read_scans(arguments, run);
  outputs.check();
  flags.apply(options, bounding_box(scans.front().positions).diagonal());
  const AlignResult result = run.timed("align", [&] { return align_scans(views_of(scans), options, run.context()); });

  for (const std::string& warning : result.warnings) run.warn(warning);
  set_report(run, arguments, options, outputs, result);
  const bool is_written = result.all_placed() || (arguments.allow_partial && result.num_placed > 1);
  if (is_written && !arguments.common.dry_run) outputs.write(scans, result);
  say_result(run, arguments, result);
  run.finish();
  if (!is_written) {
    throw PostconditionFailed(fmt::format("{} of {} scans could be placed, nothing was written{}", result.num_placed,
                                          scans.size(),
                                          result.num_placed > 1 ? " (--allow-partial writes those)" : ""));
  }
  return result.all_placed() ? 0 : kNotAllPlaced;
}

}  // namespace

Command add_align_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("align", "Bring many overlapping scans into one frame.");
  auto arguments = std::make_shared<AlignArguments>();
  command->add_option("scans", arguments->scans, "Meshes, range images or point clouds, two or more.")
      ->required()
      ->type_name("SCAN");
  command
      ->add_option("-o,--output", arguments->output,
                   "Folder for SCAN.pose.txt (scan into world), merged.ply and report.json.")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--merged-spacing", arguments->merged_spacing,
                   "Thin merged.ply: one point per cell of this size, in the files' units or % of the diagonal.")
      ->type_name("E");
  command->add_flag("--no-merged", arguments->no_merged, "Write no merged.ply.");
  command->add_flag("--allow-partial", arguments->allow_partial,
                    "Write the scans that could be placed when others could not (exit code 6).");
  auto flags = std::make_shared<DescribedFlags<AlignOptions>>(
      *command, std::initializer_list<std::string_view>{"method", "sampler", "ratio", "skip-boundary", "polish",
                                                        "min-confidence", "sequence", "refine", "seed"});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_align(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
