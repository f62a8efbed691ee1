#pragma once

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "shapelight/registration/registration_cloud.hpp"
#include "support/data_files.hpp"
#include "support/shapes.hpp"

/// Clouds to register: a surface without symmetry, real scans, and clouds that leave motions open.
namespace shapelight::testing {

/// Turns by `angle` about `axis` and shifts.
inline RigidTransform motion(double angle, const Vec3& axis, const Vec3& shift) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  T.translation() = shift;
  return T;
}

inline double rotation_between(const RigidTransform& a, const RigidTransform& b) {
  const Eigen::Quaterniond q(Eigen::Matrix3d(a.linear().transpose() * b.linear()));
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

inline std::vector<Vec3> moved(std::vector<Vec3> points, const RigidTransform& T) {
  for (Vec3& p : points) p = T * p;
  return points;
}
inline std::vector<Vec3> turned(std::vector<Vec3> normals, const RigidTransform& T) {
  for (Vec3& n : normals) n = T.linear() * n;
  return normals;
}

/// A wavy sheet of about 2 x 2 with exact normals, irregular enough to determine every motion.
struct Sheet {
  std::vector<Vec3> positions, normals;
};
inline Sheet wavy_sheet(std::size_t count, std::uint64_t seed) {
  Sheet sheet;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 2.0 * random01(seed, 0, i) - 1.0, y = 2.0 * random01(seed, 1, i) - 1.0;
    sheet.positions.emplace_back(x, y, 0.3 * std::sin(3.0 * x + 1.0) * std::cos(2.0 * y) + 0.2 * x * y);
    const double dx = 0.9 * std::cos(3.0 * x + 1.0) * std::cos(2.0 * y) + 0.2 * y;
    const double dy = -0.6 * std::sin(3.0 * x + 1.0) * std::sin(2.0 * y) + 0.2 * x;
    sheet.normals.push_back(Vec3(-dx, -dy, 1.0).normalized());
  }
  return sheet;
}

/// Every `stride`-th point of two shipped scans, each relative to its middle, and their published pose.
struct ScanPair {
  std::vector<Vec3> source, target;
  RigidTransform T_target_source;
};
inline ScanPair dragon_pair(std::size_t stride) {
  const auto points = [&](const char* name, Vec3& middle) {
    const Geometry scan = read_data(std::string("scans/") + name);
    middle = bounding_box(scan.positions).center();
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < scan.size(); i += stride) kept.push_back(scan.positions[i] - middle);
    return kept;
  };
  ScanPair pair;
  Vec3 source_middle, target_middle;
  pair.source = points("dragonStandRight_24.ply", source_middle);
  pair.target = points("dragonStandRight_0.ply", target_middle);
  std::ifstream file(SHAPELIGHT_DATA_DIR "/scans/T_dragonStandRight_24_to_0.txt");
  RigidTransform T = RigidTransform::Identity();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) file >> T.matrix()(row, column);
  }
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  T.translation() = T * source_middle - target_middle;
  pair.T_target_source = T;
  return pair;
}

/// Clouds of 60 points that leave motions open, each with normals: one place, a line, a plane, two places.
struct OpenCloud {
  std::string name;
  std::vector<Vec3> positions, normals;
};
inline std::vector<OpenCloud> open_clouds() {
  std::vector<OpenCloud> clouds = {{"place", {}, {}}, {"line", {}, {}}, {"plane", {}, {}}, {"two places", {}, {}}};
  for (std::size_t i = 0; i < 60; ++i) {
    const double x = random01(3, 0, i), y = random01(3, 1, i);
    clouds[0].positions.emplace_back(0.3, 0.2, 0.1);
    clouds[1].positions.emplace_back(x, 2.0 * x, -x);
    clouds[2].positions.emplace_back(x, y, 0.0);
    clouds[3].positions.emplace_back(i % 2 == 0 ? 0.0 : 1.0, 0.0, 0.0);
  }
  for (OpenCloud& cloud : clouds) cloud.normals.assign(60, Vec3::UnitZ());
  return clouds;
}

}  // namespace shapelight::testing
