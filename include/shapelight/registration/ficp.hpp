#pragma once

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

/// Parameters of register_by_ficp().
struct FicpOptions {
  double lambda = 0.95;        ///< [1] exponent of the inlier fraction: large keeps more pairs
  double start_lambda = 3.0;   ///< [1] annealing starts here, with a wide basin, and ends at lambda; equal: pure FICP
  double min_fraction = 0.05;  ///< [1] never trust fewer pairs than this share of the source (and never fewer than 10)
  double max_fraction = 1.0;   ///< [1]
  int max_iterations = 400;    ///< [iterations] per value of lambda
  double rotation_tolerance = 1e-6;     ///< [rad] stop when a step turns less, and ...
  double translation_tolerance = 1e-6;  ///< [target diagonals] ... moves less

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"lambda", "1", "Exponent of the inlier fraction.", 0.01, 100}, o.lambda);
    visit(OptionInfo{"start-lambda", "1", "Where annealing starts; equal to lambda: pure FICP.", 0.01, 100},
          o.start_lambda);
    visit(OptionInfo{"min-fraction", "1", "Smallest share of the pairs to trust.", 0.001, 1}, o.min_fraction);
    visit(OptionInfo{"max-fraction", "1", "Largest share of the pairs to trust.", 0.001, 1}, o.max_fraction);
    visit(OptionInfo{"max-iterations", "iterations", "Iterations at most, per value of lambda.", 1, 100000},
          o.max_iterations);
    visit(OptionInfo{"rotation-tolerance", "rad", "Stop when a step turns less.", 0, 1}, o.rotation_tolerance);
    visit(OptionInfo{"translation-tolerance", "diagonals", "Stop when a step moves less.", 0, 1},
          o.translation_tolerance);
  }
};

/// Fractional ICP (Phillips, Liu and Tomasi 2007): finds the motion and the share f of inliers that minimise
///   FRMSD = f^-lambda sqrt(mean over the f n closest pairs of |R p + t - q|^2).
/// Each of its three steps (closest points, best f, best motion) lowers the FRMSD, so it falls monotonically for a
/// fixed lambda; result.error holds it. With start_lambda above lambda it first runs to its end at start_lambda, then
/// at lambda, which widens the basin (ours); error then has one monotone run after the other. Source: paper, section
/// III.B. Pre: both clouds hold 10 points or more. Throws InvalidInput, Cancelled. Cost: per iteration one tree search
/// for each source point whose nearest may have changed, and sorting n distances.
[[nodiscard]] RegistrationResult register_by_ficp(const RegistrationCloud& source, const RegistrationCloud& target,
                                                  const RigidTransform& T_target_source,
                                                  const FicpOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
