#include "repeatability.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"

namespace shapelight::bench {
namespace {

// Every sample at a random point nearby: keeps how dense the samples lie, and nothing of their places.
KdTree shuffled(const RegistrationCloud& full, std::span<const Index> samples, double reach) {
  std::vector<Vec3> places;
  std::vector<Neighbor> near;
  for (const Index i : samples) {
    full.tree.within(full.position[i], reach, near);
    const auto pick = static_cast<std::size_t>(random01(77, 0, i) * static_cast<double>(near.size()));
    places.push_back(full.position[near[pick].index]);
  }
  return KdTree(places);
}

}  // namespace

Repeatability measure_repeatability(const Pair& pair, std::span<const Index> source, std::span<const Index> target) {
  const RegistrationCloud& full = pair.target.prepared.full;
  const RegistrationCloud &from = pair.source.prepared.samples, &to = pair.target.prepared.samples;
  const double eq = full.spacing * std::sqrt(static_cast<double>(full.size()) /
                                             static_cast<double>(std::max<std::size_t>(1, to.size())));
  const KdTree by_chance = shuffled(full, target, 1.5 * eq);
  const RigidTransform T_source_target = pair.T_target_source.inverse();

  Repeatability result;
  double counterparts = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    result.boundary += pair.source.is_boundary[source[i]];
    const Vec3 p = pair.T_target_source * from.position[i];
    if (full.tree.nearest(p).distance_sq > 9.0 * full.spacing * full.spacing) continue;
    ++counterparts;
    const Neighbor nearest = to.tree.nearest(p);
    const bool is_hit = nearest.distance_sq <= 0.25 * eq * eq;
    result.hit += is_hit;
    result.chance += by_chance.nearest(p).distance_sq <= 0.25 * eq * eq;
    result.close_hit += nearest.distance_sq <= full.spacing * full.spacing;
    result.mutual += is_hit && from.tree.nearest(T_source_target * to.position[nearest.index]).index == i;
  }
  const double all = std::max(1.0, static_cast<double>(source.size())), others = std::max(1.0, counterparts);
  result.no_counterpart = 1.0 - counterparts / all;
  result.boundary /= all;
  for (double* share : {&result.hit, &result.chance, &result.close_hit, &result.mutual}) *share /= others;
  return result;
}

}  // namespace shapelight::bench
