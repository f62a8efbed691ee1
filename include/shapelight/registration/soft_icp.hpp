#pragma once

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "shapelight/registration/registration_result.hpp"

namespace shapelight {

/// Parameters of register_by_soft_icp(). Zero means: chosen by the number of candidates.
struct SoftIcpOptions {
  int candidates = 1;        ///< [points] nearest points each way that a point may be matched with; 1 as Liu does
  double rate = 0.85;        ///< [1] sigma shrinks by this factor
  double kappa = 0.0;        ///< [sigma] a pair closer than this outweighs the slack; 0: 1.5 for one candidate, else 2
  double final_sigma = 0.0;  ///< [point spacings] where annealing ends; 0: 0.5 for one candidate, else 0.35
  int balance_passes = 4;    ///< [passes] of Sinkhorn's row and column normalisation
  int max_iterations = 60;   ///< [iterations] at the final sigma
  double tolerance = 1e-6;   ///< [rad and target diagonals] stop there when a step turns and moves less

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"candidates", "points", "Nearest points each way that a point may be matched with.", 1, 64},
          o.candidates);
    visit(OptionInfo{"rate", "1", "Factor by which sigma shrinks.", 0.1, 0.99}, o.rate);
    visit(OptionInfo{"kappa", "sigma", "A pair closer than this outweighs the slack; 0: by the candidates.", 0, 10},
          o.kappa);
    visit(OptionInfo{"final-sigma", "point spacings", "Where annealing ends; 0: by the candidates.", 0, 10},
          o.final_sigma);
    visit(OptionInfo{"balance-passes", "passes", "Passes of row and column normalisation.", 1, 100}, o.balance_passes);
    visit(OptionInfo{"max-iterations", "iterations", "Iterations at the final sigma at most.", 1, 100000},
          o.max_iterations);
    visit(OptionInfo{"tolerance", "rad, diagonals", "Stop when a step is smaller.", 0, 1}, o.tolerance);
  }
};

/// SoftICP: closest-point softassign with the two-way constraint, annealed. Every point may be matched with its nearest
/// ones each way; the weights exp((kappa^2 sigma^2 - d^2) / 2 sigma^2), beside slack cells, are made doubly stochastic
/// by Sinkhorn's normalisation; the motion is the weighted least squares one; sigma shrinks, and at its end the
/// iteration runs on until it stands still. A reconstruction: the paper names Liu's SoftICP without a reference list.
/// Verified from the abstract of Liu, "A mean field annealing approach to accurate free form shape matching" (2007):
/// closest-point candidates, closed-form weights, annealing, quaternion least squares. Ours: the constants, the
/// dimensionless slack, the run to convergence. result.error and rms are the weighted root mean square, inlier_ratio is
/// the sum of the weights over the number of source points. Pre: both clouds hold 10 points or more. Throws
/// InvalidInput, Cancelled. Cost: per iteration tree searches both ways and O(n k) time and memory.
[[nodiscard]] RegistrationResult register_by_soft_icp(const RegistrationCloud& source, const RegistrationCloud& target,
                                                      const RigidTransform& T_target_source,
                                                      const SoftIcpOptions& options = {},
                                                      const RunContext& context = {});

}  // namespace shapelight
