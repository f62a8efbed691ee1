#include "registration/pose_solver.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace shapelight::registration {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr std::ptrdiff_t kFixed = -1;

// Normal equations of all free scans; x of a scan is a motion applied from the right: T_world_scan motion_of(x).
struct PoseSystem {
  SparseMatrix hessian;
  Eigen::VectorXd gradient;
};

PoseSystem assemble(std::span<const RigidTransform> poses, std::span<const PairTerm> terms,
                    const std::vector<std::ptrdiff_t>& block, std::ptrdiff_t num_blocks) {
  std::vector<Eigen::Triplet<double>> entries;
  PoseSystem system{SparseMatrix(6 * num_blocks, 6 * num_blocks), Eigen::VectorXd::Zero(6 * num_blocks)};
  const auto add_block = [&](std::ptrdiff_t row, std::ptrdiff_t column, const Matrix6& values) {
    if (row == kFixed || column == kFixed) return;
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) entries.emplace_back(6 * row + r, 6 * column + c, values(r, c));
    }
  };
  for (const PairTerm& term : terms) {
    // motion(-x_t) T_ts motion(x_s) = motion(A x_s - x_t) T_ts.
    const Matrix6 A = adjoint(poses[term.target].inverse() * poses[term.source]);
    const std::ptrdiff_t t = block[term.target], s = block[term.source];
    const Matrix6 HA = term.hessian * A;
    add_block(t, t, term.hessian);
    add_block(t, s, -HA);
    add_block(s, t, -HA.transpose());
    add_block(s, s, A.transpose() * HA);
    if (t != kFixed) system.gradient.segment<6>(6 * t) -= term.gradient;
    if (s != kFixed) system.gradient.segment<6>(6 * s) += A.transpose() * term.gradient;
  }
  system.hessian.setFromTriplets(entries.begin(), entries.end());
  return system;
}

// Marquardt's damping: relative to the diagonal, so that it knows no units.
bool solve_damped(PoseSystem system, double damping, Eigen::VectorXd& step) {
  for (Eigen::Index i = 0; i < system.gradient.size(); ++i) {
    double& diagonal = system.hessian.coeffRef(i, i);
    diagonal += damping * diagonal;
  }
  const Eigen::SimplicialLDLT<SparseMatrix> factors(system.hessian);
  if (factors.info() != Eigen::Success || (factors.vectorD().array() <= 0.0).any()) return false;
  step = factors.solve(-system.gradient);
  return step.allFinite();
}

std::vector<RigidTransform> moved(const std::vector<RigidTransform>& poses, const std::vector<std::ptrdiff_t>& block,
                                  const Eigen::VectorXd& step) {
  std::vector<RigidTransform> result = poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (block[i] == kFixed) continue;
    result[i] = poses[i] * motion_of(step.segment<6>(6 * block[i]));
    // Products drift away from a rotation.
    result[i].linear() = Eigen::Quaterniond(result[i].linear()).normalized().toRotationMatrix();
  }
  return result;
}

// Position of each scan's unknowns; fixed ones and those that no pair holds have none.
std::vector<std::ptrdiff_t> number_blocks(std::size_t num_scans, const std::vector<bool>& is_fixed,
                                          std::span<const PairTerm> terms) {
  std::vector<bool> is_free(num_scans, false);
  for (const PairTerm& term : terms) {
    if (!term.hessian.isZero(0.0)) is_free[term.target] = is_free[term.source] = true;
  }
  std::vector<std::ptrdiff_t> block(num_scans, kFixed);
  std::ptrdiff_t next = 0;
  for (std::size_t i = 0; i < num_scans; ++i) {
    if (is_free[i] && !is_fixed[i]) block[i] = next++;
  }
  return block;
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Vec3& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

RigidTransform motion_of(const Vector6& coordinates) {
  const Vec3 rotation = coordinates.head<3>();
  const double angle = rotation.norm();
  RigidTransform motion = RigidTransform::Identity();
  if (angle > 0.0) motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  motion.translation() = coordinates.tail<3>();
  return motion;
}

Vector6 coordinates_of(const RigidTransform& motion) {
  const Eigen::AngleAxisd rotation(motion.linear());
  Vector6 coordinates;
  coordinates << rotation.angle() * rotation.axis(), motion.translation();
  return coordinates;
}

Matrix6 coordinate_jacobian(const RigidTransform& motion) {
  const Eigen::AngleAxisd rotation(motion.linear());
  const double half = 0.5 * rotation.angle();
  const double shrink = half < 1e-4 ? 1.0 - half * half / 3.0 : half / std::tan(half);  // half cot(half)
  const Vec3& axis = rotation.axis();
  Matrix6 jacobian = Matrix6::Identity();
  // Inverse of the left Jacobian of SO(3); the translation t of the motion becomes t + rotation x t + translation.
  jacobian.topLeftCorner<3, 3>() =
      shrink * Eigen::Matrix3d::Identity() + (1.0 - shrink) * axis * axis.transpose() - half * cross_matrix(axis);
  jacobian.bottomLeftCorner<3, 3>() = -cross_matrix(motion.translation());
  return jacobian;
}

Matrix6 adjoint(const RigidTransform& T) {
  Matrix6 A = Matrix6::Zero();
  A.topLeftCorner<3, 3>() = T.linear();
  A.bottomRightCorner<3, 3>() = T.linear();
  A.bottomLeftCorner<3, 3>() = cross_matrix(T.translation()) * T.linear();
  return A;
}

PoseFit fit_poses(std::vector<RigidTransform>& T_world_scan, const std::vector<bool>& is_fixed,
                  const PairCostFunction& cost_at, int max_iterations, double tolerance, const RunContext& context) {
  constexpr double kSmallestDamping = 1e-12, kLargestDamping = 1e12;
  PairCost here = cost_at(T_world_scan);
  const std::vector<std::ptrdiff_t> block = number_blocks(T_world_scan.size(), is_fixed, here.terms);
  const auto num_blocks =
      std::count_if(block.begin(), block.end(), [](std::ptrdiff_t position) { return position != kFixed; });
  PoseFit fit{here.value, 0, num_blocks == 0};
  double damping = 1e-6;
  while (fit.iterations < max_iterations && !fit.converged) {
    context.check();
    ++fit.iterations;
    const PoseSystem system = assemble(T_world_scan, here.terms, block, num_blocks);
    bool is_lower = false;
    for (; !is_lower && damping < kLargestDamping && !fit.converged; damping *= is_lower ? 0.1 : 10.0) {
      Eigen::VectorXd step;
      if (!solve_damped(system, damping, step)) continue;
      fit.converged = -system.gradient.dot(step) <= tolerance * (1.0 + fit.cost);
      std::vector<RigidTransform> candidate = moved(T_world_scan, block, step);
      PairCost there = cost_at(candidate);
      is_lower = there.value < fit.cost;
      if (!is_lower) continue;
      T_world_scan = std::move(candidate);
      here = std::move(there);
      fit.cost = here.value;
    }
    damping = std::max(damping, kSmallestDamping);
    fit.converged = fit.converged || !is_lower;
  }
  return fit;
}

ScanGroups::ScanGroups(std::size_t num_scans) : parent_(num_scans) { std::iota(parent_.begin(), parent_.end(), 0); }

std::size_t ScanGroups::find(std::size_t scan) {
  while (parent_[scan] != scan) scan = parent_[scan] = parent_[parent_[scan]];
  return scan;
}

bool ScanGroups::unite(std::size_t a, std::size_t b) {
  a = find(a), b = find(b);
  parent_[std::max(a, b)] = std::min(a, b);
  return a != b;
}

std::vector<bool> ScanGroups::first_of_each() {
  std::vector<bool> is_first(parent_.size());
  for (std::size_t i = 0; i < parent_.size(); ++i) is_first[i] = parent_[i] == i;
  return is_first;
}

}  // namespace shapelight::registration
