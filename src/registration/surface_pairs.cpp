#include "registration/surface_pairs.hpp"

#include "core/parallel.hpp"

namespace shapelight::registration {
namespace {

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

}  // namespace shapelight::registration
