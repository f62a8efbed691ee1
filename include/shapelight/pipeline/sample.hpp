#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/pipeline/fields.hpp"

namespace shapelight {

enum class SamplingMethod : std::uint8_t { Shape, Random, Voxel, Stratified, Farthest, Poisson, Normal, Covariance };

[[nodiscard]] constexpr auto enum_names(SamplingMethod) {
  return std::array<std::pair<SamplingMethod, std::string_view>, 8>{{{SamplingMethod::Shape, "shape"},
                                                                     {SamplingMethod::Random, "random"},
                                                                     {SamplingMethod::Voxel, "voxel"},
                                                                     {SamplingMethod::Stratified, "stratified"},
                                                                     {SamplingMethod::Farthest, "farthest"},
                                                                     {SamplingMethod::Poisson, "poisson"},
                                                                     {SamplingMethod::Normal, "normal"},
                                                                     {SamplingMethod::Covariance, "covariance"}}};
}

/// How many points to keep: exactly one member is set.
struct SampleSize {
  std::optional<std::uint64_t> count;  ///< [points]
  std::optional<double> ratio;    ///< [1] share of the finite points, in (0, 1]; rounded to the nearest, at least 1
  std::optional<double> spacing;  ///< [input length unit] see the method for what it bounds
};

/// Throws InvalidInput unless exactly one member is set and in range.
void validate(const SampleSize& size);

/// What sample() does; start from sample_preset().
struct SampleOptions {
  Preset preset = Preset::Detail;  ///< Paper: the paper's sampler in place of ours
  SamplingMethod method = SamplingMethod::Shape;
  double local_weight = 0.65;  ///< [1] T of eq. 14
  bool skip_boundary = false;  ///< leave out points on the border: in registration they have no counterpart
  std::uint64_t seed = 0;      ///< of the methods that draw at random
  FieldsOptions fields;        ///< of method Shape

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"method", "", "How points are chosen.", 0, 0}, o.method);
    visit(OptionInfo{"local-weight", "1", "Share of points chosen for local detail (the paper's T).", 0, 1},
          o.local_weight);
    visit(OptionInfo{"skip-boundary", "", "Leave out points on the border of an open surface.", 0, 1}, o.skip_boundary);
    visit(OptionInfo{"seed", "", "Seed of the methods that draw at random.", 0, 0x1.0p64}, o.seed);
    FieldsOptions::describe(o.fields, visit);
  }
};

[[nodiscard]] SampleOptions sample_preset(Preset preset);

struct SampleResult {
  std::vector<Index> indices;   ///< input indices, unique, in the order of selection; of method Shape a ranking
  std::size_t usable = 0;       ///< finite points of the input
  std::size_t candidates = 0;   ///< of those, distinct, not flagged, and not skipped
  std::size_t last_resort = 0;  ///< chosen although flagged or duplicate, since the count asked for it
  double noise = 0.0;           ///< sigma, [input length unit]; method Shape
  bool denoised = false;
  GraphDiagnostics diagnostics;
};

/// Keeps the points that carry the shape: exactly as many as asked for, none twice (paper, section II.D).
/// Flagged strays and duplicates are chosen last, and only when the count leaves no other way;
/// skipped boundary points and non-finite ones never.
/// Throws InvalidInput (options, or not exactly one size), TargetUnreachable (fewer points can be chosen than asked
/// for; the message says how many), Cancelled. Same result for any RunContext and any order of the input.
[[nodiscard]] SampleResult sample(const GeometryView& geometry, const SampleSize& size, const SampleOptions& options = {},
                                  const RunContext& context = {});

}  // namespace shapelight
