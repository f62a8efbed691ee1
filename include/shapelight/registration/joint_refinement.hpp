#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/registration/registration_cloud.hpp"

namespace shapelight {

/// Parameters of refine_jointly().
struct JointRefinementOptions {
  double max_distance = 3.0;  ///< [target spacings] across the surface: points farther apart do not correspond
  double max_slide = 2.0;     ///< [target spacings] along the surface: beyond, the target ends or has a hole
  int max_iterations = 30;    ///< [iterations]
  double tolerance = 0.01;    ///< [target spacings] stop when no scan moves more

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"max-distance", "target spacings", "Points farther apart do not correspond.", 0.1, 1e6},
          o.max_distance);
    visit(OptionInfo{"max-slide", "target spacings", "The same, along the surface.", 0.1, 1e6}, o.max_slide);
    visit(OptionInfo{"max-iterations", "iterations", "Iterations at most.", 1, 100000}, o.max_iterations);
    visit(OptionInfo{"tolerance", "target spacings", "Stop when no scan moves more.", 0, 1}, o.tolerance);
  }
};

/// One scan: the samples are moved, the full scan is the surface that others are held against. It has normals; with a
/// viewpoint they look there, and the two sides of a sheet are told apart.
struct ScanView {
  const RegistrationCloud* full = nullptr;
  const RegistrationCloud* samples = nullptr;
};

/// How two surfaces lie on each other, both ways: the samples of each against the full other one.
struct PairFit {
  double overlap = 0.0;     ///< [1] share of the samples with a counterpart, of the scan that has the larger share
  std::size_t matches = 0;  ///< [samples] of both, that have one
  double rms = 0.0;         ///< [input length unit] point to plane, over the counterparts; 0 without any
};
/// Throws InvalidInput (options, a scan without normals: the target is scan 0, the source scan 1).
[[nodiscard]] PairFit measure_fit(const ScanView& target, const ScanView& source, const RigidTransform& T_target_source,
                                  const JointRefinementOptions& options = {});

struct JointRefinementResult {
  std::vector<RigidTransform> T_world_scan;
  std::size_t iterations = 0;
  bool converged = false;
};

/// Moves all scans at once so that, over all pairs and both ways, samples lie on the other scan's surface: point to
/// plane, reweighted by Geman and McClure at three robust standard deviations of the pair. Errors of single pairs
/// cannot add up around an object, and what every pair sees counts. The first scan of each connected set stays.
/// Pre: pairs name two different scans each; scans named have normals (InvalidInput). Poses are near the optimum.
/// Throws InvalidInput, Cancelled. Cost: per iteration a tree search per sample and pair, one sparse factorisation.
[[nodiscard]] JointRefinementResult refine_jointly(std::span<const ScanView> scans,
                                                   std::span<const std::pair<std::size_t, std::size_t>> pairs,
                                                   std::span<const RigidTransform> T_world_scan,
                                                   const JointRefinementOptions& options = {},
                                                   const RunContext& context = {});

}  // namespace shapelight
