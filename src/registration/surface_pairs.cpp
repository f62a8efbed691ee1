#include "registration/surface_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace shapelight::registration {
namespace {

constexpr double kGaussian = 1.4826;  // standard deviation over median of absolute values

// Of the overlap within the gate.
std::vector<double> heights_within(std::span<const SurfacePair> pairs, double gate) {
  std::vector<double> heights;
  for (const SurfacePair& pair : pairs) {
    if (is_overlap(pair, gate)) heights.push_back(std::abs(pair.height));
  }
  return heights;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

SurfacePair pair_of(const Vec3& moved, const Vec3& normal, const RegistrationCloud& to, const Neighbor& nearest) {
  const Vec3& there = to.normal[nearest.index];
  return {std::sqrt(nearest.distance_sq), (moved - to.position[nearest.index]).dot(there), normal.dot(there),
          nearest.index};
}

}  // namespace

std::vector<SurfacePair> pair_surfaces(const RegistrationCloud& from, std::span<const Index> chosen,
                                       const RegistrationCloud& to, const RigidTransform& T_to_from,
                                       const RunContext& context) {
  std::vector<SurfacePair> pairs(chosen.size());
  parallel::for_chunks(context, chosen.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 moved = T_to_from * from.position[chosen[i]];
      pairs[i] = pair_of(moved, T_to_from.linear() * from.normal[chosen[i]], to, to.tree.nearest(moved));
    }
  });
  return pairs;
}

std::vector<SurfacePair> pair_surfaces(const RegistrationCloud& from, const RegistrationCloud& to,
                                       const RigidTransform& T_to_from, const RunContext& context) {
  std::vector<SurfacePair> pairs(from.size());
  parallel::for_chunks(context, from.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 moved = T_to_from * from.position[i];
      pairs[i] = pair_of(moved, T_to_from.linear() * from.normal[i], to, to.tree.nearest(moved));
    }
  });
  return pairs;
}

void forget_sides(std::span<SurfacePair> pairs, const RegistrationCloud& a, const RegistrationCloud& b) {
  if (a.viewpoint && b.viewpoint) return;
  for (SurfacePair& pair : pairs) pair.cosine = std::abs(pair.cosine);
}

SurfaceGate find_gate(std::span<const SurfacePair> pairs, double widest, double narrowest) {
  constexpr double kResiduals = 6.0;  // the gate is this many of them wide
  constexpr int kSteps = 20;
  std::vector<double> heights = heights_within(pairs, widest);
  const double num_wide = static_cast<double>(heights.size());
  SurfaceGate gate{widest, kGaussian * median(heights), 0.0};
  for (int step = 0; step < kSteps; ++step) {
    const double width = std::max(narrowest, std::min(gate.width, kResiduals * gate.residual));
    if (width >= 0.99 * gate.width) break;
    heights = heights_within(pairs, width);
    gate.width = width;
    gate.residual = kGaussian * median(heights);
  }
  if (num_wide > 0.0 && gate.width > 0.0) {
    gate.contrast = static_cast<double>(heights.size()) / num_wide * widest / gate.width;
  }
  return gate;
}

double widest_gate(const RegistrationCloud& a, const RegistrationCloud& b) {
  return std::max(0.03 * std::min(a.diagonal, b.diagonal), narrowest_gate(a, b));
}

double narrowest_gate(const RegistrationCloud& a, const RegistrationCloud& b) {
  return 3.0 * std::max(a.spacing, b.spacing);
}

}  // namespace shapelight::registration
