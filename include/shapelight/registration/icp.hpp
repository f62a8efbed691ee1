#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

/// What a pair of points costs. Point: |Rp + t - q|^2 (Besl and McKay 1992). Plane: ((Rp + t - q) . n_q)^2 (Chen and
/// Medioni 1992). Gicp: plane to plane, (Rp + t - q)^T (C_q + R C_p R^T)^-1 (Rp + t - q) with the covariances that the
/// normals span (Segal, Haehnel and Thrun 2009).
enum class IcpMetric : std::uint8_t { Point, Plane, Gicp };

[[nodiscard]] constexpr auto enum_names(IcpMetric) {
  return std::array<std::pair<IcpMetric, std::string_view>, 3>{
      {{IcpMetric::Point, "point"}, {IcpMetric::Plane, "plane"}, {IcpMetric::Gicp, "gicp"}}};
}

/// Parameters of register_by_icp().
struct IcpOptions {
  IcpMetric metric = IcpMetric::Plane;
  double max_distance =
      0.0;  ///< [input length unit] pairs farther apart have no say; 0: a tenth of the target's diagonal
  int max_iterations = 100;             ///< [iterations]
  double rotation_tolerance = 1e-6;     ///< [rad] stop when a step turns less, and ...
  double translation_tolerance = 1e-6;  ///< [target diagonals] ... moves less

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"metric", "", "What a pair of points costs.", 0, 0}, o.metric);
    visit(OptionInfo{"max-distance", "input length unit",
                     "Pairs farther apart have no say; 0: a tenth of the diagonal.", 0, 1e300},
          o.max_distance);
    visit(OptionInfo{"max-iterations", "iterations", "Iterations at most.", 1, 100000}, o.max_iterations);
    visit(OptionInfo{"rotation-tolerance", "rad", "Stop when a step turns less.", 0, 1}, o.rotation_tolerance);
    visit(OptionInfo{"translation-tolerance", "diagonals", "Stop when a step moves less.", 0, 1},
          o.translation_tolerance);
  }
};

/// Iterated closest points: pairs every source point with its closest target point, moves the source so that the pairs
/// cost least (closed form for Point, one Gauss-Newton step for the others), and repeats.
/// Pre: Plane needs the target's normals, Gicp those of both (InvalidInput); both clouds hold 3 points or more.
/// Points whose normal is undefined are left out by the metrics that need it. Throws InvalidInput, Cancelled.
/// Cost: per iteration one tree search for each source point whose nearest may have changed.
[[nodiscard]] RegistrationResult register_by_icp(const RegistrationCloud& source, const RegistrationCloud& target,
                                                 const RigidTransform& T_target_source, const IcpOptions& options = {},
                                                 const RunContext& context = {});

}  // namespace shapelight
