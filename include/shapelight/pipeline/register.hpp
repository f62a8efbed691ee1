#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/registration/pose_assessment.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

enum class RegistrationMethod : std::uint8_t { Ficp, FicpPure, SoftIcp, Icp, Plane, Gicp };

[[nodiscard]] constexpr auto enum_names(RegistrationMethod) {
  return std::array<std::pair<RegistrationMethod, std::string_view>, 6>{{{RegistrationMethod::Ficp, "ficp"},
                                                                         {RegistrationMethod::FicpPure, "ficp-pure"},
                                                                         {RegistrationMethod::SoftIcp, "softicp"},
                                                                         {RegistrationMethod::Icp, "icp"},
                                                                         {RegistrationMethod::Plane, "plane"},
                                                                         {RegistrationMethod::Gicp, "gicp"}}};
}

/// What register_scans() does.
struct RegisterOptions {
  RegistrationMethod method = RegistrationMethod::Ficp;
  SamplingMethod sampler = SamplingMethod::Shape;
  double ratio = 0.0;         ///< [1] share of each scan's points that is registered; 0: 2000 to 10000 points
  bool skip_boundary = true;  ///< choose no points on the border of a scan: they have no counterpart
  bool coarse = true;         ///< without a starting pose look for one; else start where the files say
  bool polish = true;  ///< at the end, a few steps against the full target's surface: of the samples, then of more
  double max_distance = 0.0;  ///< [input length unit] of icp, plane and gicp; 0: a tenth of the target's diagonal
  std::uint64_t seed = 0;     ///< of samplers that draw at random

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"method", "", "How the scans are brought together.", 0, 0}, o.method);
    visit(OptionInfo{"sampler", "", "How points are chosen; both scans are thinned.", 0, 0}, o.sampler);
    visit(OptionInfo{"ratio", "1", "Share of each scan's points to register; 0: 2000 to 10000 points.", 0, 1}, o.ratio);
    visit(OptionInfo{"skip-boundary", "", "Choose no points on the border of a scan.", 0, 1}, o.skip_boundary);
    visit(OptionInfo{"coarse", "", "Without --init look for a starting pose; else start where the files say.", 0, 1},
          o.coarse);
    visit(OptionInfo{"polish", "", "At the end, a few steps against the full target.", 0, 1}, o.polish);
    visit(OptionInfo{"max-distance", "input length unit",
                     "Pairs farther apart have no say (icp, plane, gicp); 0: a tenth of the diagonal.", 0, 1e300},
          o.max_distance);
    visit(OptionInfo{"seed", "", "Seed of the samplers that draw at random.", 0, 0x1.0p64}, o.seed);
  }
};

/// A scan made ready to be registered with others. Coordinates are relative to `origin` (input frame).
struct PreparedScan {
  Vec3 origin = Vec3::Zero();
  RegistrationCloud full;        ///< the distinct finite points that are no strays, with normals
  RegistrationCloud samples;     ///< those that carry its shape, with the normals of the full scan
  std::vector<Index> keypoints;  ///< of `full`, best first: where descriptors are taken
};

/// Thins a scan. `name` is what messages call it. Throws FormatError (too few points to register), InvalidInput,
/// Cancelled.
[[nodiscard]] PreparedScan prepare_scan(const GeometryView& geometry, const RegisterOptions& options = {},
                                        std::string_view name = "scan", const RunContext& context = {});

struct RegisterResult {
  RigidTransform T_target_source = RigidTransform::Identity();  ///< input frames: p_target = R p_source + t
  RegistrationResult registration;  ///< of the method, between the scans' origins; the polish is not in it
  PoseAssessment assessment;        ///< of the final pose, between the scans' origins; confidence is in it
  std::size_t source_samples = 0;
  std::size_t target_samples = 0;
  std::size_t hypotheses = 0;  ///< starting poses tried; 0 when one was given
  double fit = 0.0;            ///< [1] how well the samples of the scan that fits better lie on the other one
  double rival_fit = 0.0;      ///< [1] the same of the best pose that is another one, of those that were tried
  std::vector<std::string> warnings;
};

/// Finds the motion that brings the source onto the target. With `init` it starts there; without, it looks for starting
/// poses by itself, which needs an overlap of about half or more. The result is assessed, never assumed: look at
/// assessment.confidence before using the pose.
/// Throws FormatError (a scan of fewer than 10 distinct points), InvalidInput, Cancelled. Same result for any
/// RunContext.
[[nodiscard]] RegisterResult register_scans(const GeometryView& source, const GeometryView& target,
                                            const std::optional<RigidTransform>& T_target_source_init = {},
                                            const RegisterOptions& options = {}, const RunContext& context = {});

/// The same for scans that were prepared, so that many pairs share the work.
[[nodiscard]] RegisterResult register_scans(const PreparedScan& source, const PreparedScan& target,
                                            const std::optional<RigidTransform>& T_target_source_init = {},
                                            const RegisterOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
