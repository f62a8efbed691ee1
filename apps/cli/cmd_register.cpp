#include <fmt/format.h>

#include <numbers>
#include <optional>

#include "attribute_choice.hpp"
#include "commands.hpp"
#include "described_options.hpp"
#include "matrix_json.hpp"
#include "run.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/pipeline/memory_estimate.hpp"
#include "shapelight/pipeline/register.hpp"

namespace shapelight::cli {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct RegisterArguments {
  std::string source, target, output, transform, init;
  double min_confidence = 0.5;
  AttributeChoice attributes;
  CommonOptions common;
};

nlohmann::ordered_json result_json(const RegisterResult& result) {
  const PoseAssessment& pose = result.assessment;
  const RegistrationResult& iteration = result.registration;
  return {{"T_target_source", matrix_json(result.T_target_source.matrix())},
          {"converged", iteration.converged()},
          {"stop", stop_reason_name(iteration.stop)},
          {"iterations", iteration.iterations},
          {"inlier_ratio", iteration.inlier_ratio},
          {"rms", iteration.rms},
          {"mean_error", pose.reciprocal.mean},
          {"std_error", pose.reciprocal.std},
          {"reciprocal_share", pose.reciprocal.share},
          {"overlap", pose.overlap},
          {"residual", pose.residual},
          {"gate", pose.gate},
          {"contrast", pose.contrast},
          {"normal_agreement", pose.normal_agreement},
          {"in_free_space", pose.in_free_space},
          {"conditioning", pose.conditioning},
          {"weakest_direction", pose.weakest.name},
          {"weakest_uncertainty", pose.weakest.uncertainty},
          {"covariance", matrix_json(pose.covariance)},
          {"fit", result.fit},
          {"rival_fit", result.rival_fit},
          {"rival_weight", pose.rival_weight},
          {"confidence", pose.confidence},
          {"doubt", pose.doubt},
          {"source_samples", result.source_samples},
          {"target_samples", result.target_samples},
          {"hypotheses", result.hypotheses}};
}

void say_result(const Run& run, const RegisterResult& result) {
  const PoseAssessment& pose = result.assessment;
  const RigidTransform& T = result.T_target_source;
  run.say(fmt::format("turned {:.3f} deg; overlap {:.0f} %, mean error {:.4g}, residual {:.3g}; {} after {} iterations",
                      Eigen::AngleAxisd(T.linear()).angle() * kDegrees, 100.0 * pose.overlap, pose.reciprocal.mean,
                      pose.residual, stop_reason_name(result.registration.stop), result.registration.iterations));
  run.say(fmt::format("confidence {:.2f}; least certain: {}", pose.confidence,
                      pose.weakest.name.empty() ? "everything" : pose.weakest.name));
}

// Outputs are written only when the pose can be trusted; the report in any case.
int run_register(const RegisterArguments& arguments, const DescribedFlags<RegisterOptions>& flags,
                 std::stop_token stop) {
  Run run("register", arguments.common, std::move(stop));
  RegisterOptions options;
  flags.apply(options);
  validate_options(options);
  if (!(arguments.min_confidence >= 0.0 && arguments.min_confidence <= 1.0)) {
    throw InvalidInput(
        fmt::format("--min-confidence: {:g} is out of range, expected 0 to 1", arguments.min_confidence));
  }
  const auto check_outputs = [&] {
    if (!arguments.output.empty()) run.check_output(arguments.output);
    if (!arguments.transform.empty()) run.check_output(arguments.transform, false);
  };
  check_outputs();
  std::optional<RigidTransform> init;
  if (!arguments.init.empty()) init = read_transform(arguments.init);

  Geometry source = run.read(arguments.source);
  const Geometry target = run.read(arguments.target);
  check_outputs();
  run.check_memory((source.size() + target.size()) * kRegisterBytesPerPoint);
  flags.apply(options, bounding_box(target.positions).diagonal());
  const RegisterResult result =
      run.timed("register", [&] { return register_scans(source, target, init, options, run.context()); });

  for (const std::string& warning : result.warnings) run.warn(warning);
  run.points_in = source.size();
  run.points_out = source.size();
  run.options = options_json(options);
  run.options["min-confidence"] = arguments.min_confidence;
  if (init) run.options["init"] = arguments.init;
  run.result = result_json(result);
  say_result(run, result);
  const bool is_trusted = result.assessment.confidence >= arguments.min_confidence;
  if (is_trusted) {
    run.attributes_dropped = arguments.attributes.apply(source.attributes);
    transform_geometry(source, result.T_target_source);
    if (!arguments.output.empty()) run.write(arguments.output, source);
    if (!arguments.transform.empty() && !arguments.common.dry_run) {
      write_transform(arguments.transform, result.T_target_source, arguments.common.force);
    }
  }
  run.finish();
  if (!is_trusted) {
    throw PostconditionFailed(fmt::format("confidence {:.2f} is below --min-confidence {:g}, nothing was written: {}",
                                          result.assessment.confidence, arguments.min_confidence,
                                          result.assessment.doubt));
  }
  return 0;
}

}  // namespace

Command add_register_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("register", "Brings one scan onto another that overlaps it.");
  auto arguments = std::make_shared<RegisterArguments>();
  command->add_option("source", arguments->source, "The scan that moves.")->required()->type_name("SOURCE");
  command->add_option("target", arguments->target, "The scan that stays.")->required()->type_name("TARGET");
  command->add_option("-o,--output", arguments->output, "The source, moved onto the target.")->type_name("ALIGNED");
  command->add_option("--transform", arguments->transform, "Writes the 4 x 4 matrix, source into target.")
      ->type_name("FILE");
  command->add_option("--init", arguments->init, "Starts from this 4 x 4 matrix, source into target.")
      ->type_name("FILE");
  command
      ->add_option("--min-confidence", arguments->min_confidence,
                   "Below it nothing is written and the exit code is 6. (0.5)")
      ->type_name("C");
  arguments->attributes.add_options(*command);
  auto flags = std::make_shared<DescribedFlags<RegisterOptions>>(
      *command, std::initializer_list<std::string_view>{"method", "sampler", "ratio", "skip-boundary", "coarse",
                                                        "polish", "max-distance", "seed"});
  add_common_options(*command, arguments->common);
  return {command, [=](std::stop_token stop) { return run_register(*arguments, *flags, std::move(stop)); }};
}

}  // namespace shapelight::cli
