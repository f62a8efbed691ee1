#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/core/types.hpp"
#include "shapelight/registration/pose_assessment.hpp"

/// Least squares over many poses that are tied to each other in pairs.
namespace shapelight::registration {

[[nodiscard]] Eigen::Matrix3d cross_matrix(const Vec3& v);  ///< cross_matrix(v) w = v x w

/// The motion p -> exp(rotation) p + translation of (rotation, translation), and back.
[[nodiscard]] RigidTransform motion_of(const Vector6& coordinates);
[[nodiscard]] Vector6 coordinates_of(const RigidTransform& motion);

/// d coordinates_of(motion_of(x) motion) / dx at x = 0.
[[nodiscard]] Matrix6 coordinate_jacobian(const RigidTransform& motion);

/// A x with A such that T motion_of(x) = motion_of(A x) T to first order.
[[nodiscard]] Matrix6 adjoint(const RigidTransform& T);

/// What it costs to move T_target_source by a small x from the left: gradient . x + x . hessian x / 2.
struct PairTerm {
  std::size_t target = 0, source = 0;
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
};

struct PairCost {
  std::vector<PairTerm> terms;
  double value = 0.0;  ///< of all pairs
};

/// The pairs' cost at given poses.
using PairCostFunction = std::function<PairCost(std::span<const RigidTransform> T_world_scan)>;

struct PoseFit {
  double cost = 0.0;
  int iterations = 0;
  bool converged = false;  ///< no step lowers the cost any more, or steps are too small to matter
};

/// Levenberg and Marquardt: moves the poses so that the cost falls; scans with is_fixed, and those without a pair,
/// stay. Every connected set of pairs must have a fixed scan. Stops when the quadratic model promises less than
/// `tolerance` of the cost plus `tolerance`.
PoseFit fit_poses(std::vector<RigidTransform>& T_world_scan, const std::vector<bool>& is_fixed,
                  const PairCostFunction& cost_at, int max_iterations, double tolerance, const RunContext& context);

/// Sets of scans that pairs connect.
class ScanGroups {
 public:
  explicit ScanGroups(std::size_t num_scans);
  std::size_t find(std::size_t scan);               ///< the first scan of its set
  bool unite(std::size_t a, std::size_t b);         ///< false when they were one set already
  [[nodiscard]] std::vector<bool> first_of_each();  ///< per scan: it is the first of its set

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace shapelight::registration
