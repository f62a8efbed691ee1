#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shapelight/graph/build_graph.hpp"
#include "shapelight/pipeline/register.hpp"

/// Pairs of scans whose relative pose is known, made ready for many registrations.
namespace shapelight::bench {

/// Coordinates are relative to the middle of the scan.
struct Scan {
  BuiltGraph built;
  GeometryKind kind = GeometryKind::Cloud;
  PreparedScan prepared;                  ///< its samples are changed from cell to cell
  std::vector<Index> place_of_vertex;     ///< of the graph, among the points of prepared.full
  std::vector<std::uint8_t> is_boundary;  ///< of the points of prepared.full
};

struct Pair {
  std::string name;
  std::string truth;  ///< "exact" or "published"
  Scan source, target;
  RigidTransform T_target_source = RigidTransform::Identity();  ///< the truth, between the middles of the scans
  Vec3 middle = Vec3::Zero();                                   ///< of the overlap, source
  double overlap = 0.0;  ///< share of the source's points within two spacings of the target's
};

/// Reads two scans and the published motion between them.
[[nodiscard]] Pair read_pair(const std::string& name, const std::string& source, const std::string& target,
                             const std::string& transform);

/// Scans a mesh twice. `noise` [share of the mesh's diagonal], `azimuth` [degrees] of the target's camera.
[[nodiscard]] Pair scan_mesh(const std::string& name, const std::string& mesh, double overlap, double noise,
                             double azimuth, int pixels);

/// The truth, turned about the middle of the overlap by an angle and shifted by up to 3 % of the target's diagonal.
struct Start {
  double angle_deg = 0.0;
  RigidTransform T_target_source;
};
/// Angles are stratified in [low, high] degrees. The same for every sampler and method.
[[nodiscard]] std::vector<Start> starting_poses(const Pair& pair, int count, double low_deg, double high_deg);

struct PoseError {
  double rotation_deg = 0.0;
  double shift = 0.0;  ///< [target diagonals] of the middle of the overlap
  [[nodiscard]] bool is_success() const { return rotation_deg < 2.0 && shift < 0.01; }
};
[[nodiscard]] PoseError error_of(const Pair& pair, const RigidTransform& T_target_source);

}  // namespace shapelight::bench
