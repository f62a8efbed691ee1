#include "shapelight/registration/coarse_alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

/// Points, normals and keypoints of a scan, in its own frame.
struct Scan {
  std::vector<Vec3> positions, normals;
  std::vector<Index> keypoints;

  [[nodiscard]] Scan moved(const RigidTransform& T, double scale = 1.0) const {
    Scan other = *this;
    for (Vec3& p : other.positions) p = scale * (T * p);
    for (Vec3& n : other.normals) n = T.linear() * n;
    return other;
  }
  [[nodiscard]] RegistrationCloud cloud() const { return RegistrationCloud(positions, normals); }
};

Scan read_scan(const std::string& name) {
  const Geometry geometry = testing::read_data(name);
  const SurfaceGraph graph = build_graph(geometry).graph;
  Scan scan;
  for (const Vec3& p : graph.position) scan.positions.push_back(p + graph.origin);
  scan.normals = graph.normal;
  SampleOptions options;
  options.skip_boundary = true;
  SampleSize size;
  size.count = 3000;
  for (const Index point : sample(geometry, size, options).indices) {
    scan.keypoints.push_back(graph.vertex_of_point[point]);
  }
  return scan;
}

const Scan& dragon(int degrees) {
  static const Scan at_0 = read_scan("scans/dragonStandRight_0.ply");
  static const Scan at_24 = read_scan("scans/dragonStandRight_24.ply");
  return degrees == 0 ? at_0 : at_24;
}

RigidTransform dragon_truth() { return read_transform(SHAPELIGHT_DATA_DIR "/scans/T_dragonStandRight_24_to_0.txt"); }

RigidTransform random_motion(std::uint64_t seed) {
  const auto number = [&](std::uint64_t id) { return 2.0 * random01(seed, 0, id) - 1.0; };
  RigidTransform T = RigidTransform::Identity();
  T.linear() = Eigen::Quaterniond(number(0), number(1), number(2), number(3)).normalized().toRotationMatrix();
  T.translation() = 0.3 * Vec3(number(4), number(5), number(6));
  return T;
}

std::vector<PoseHypothesis> align(const Scan& source, const Scan& target, const CoarseAlignmentOptions& options = {},
                                  const RunContext& context = {}) {
  const RegistrationCloud a = source.cloud();
  const RegistrationCloud b = target.cloud();
  const double spacing = std::max(coarse_spacing(a), coarse_spacing(b));
  return align_coarsely(describe_points(a, source.keypoints, spacing, context),
                        describe_points(b, target.keypoints, spacing, context), options, context);
}

/// Mean distance between where two poses put the scan, in diagonals.
double apart(const RigidTransform& a, const RigidTransform& b, const Scan& scan) {
  double sum = 0.0;
  for (const Vec3& p : scan.positions) sum += (a * p - b * p).norm();
  return sum / static_cast<double>(scan.positions.size()) / bounding_box(scan.positions).diagonal();
}

TEST(CoarseAlignment, FindsTheDragonFromAnywhere) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const RigidTransform motion = random_motion(seed);
    const Scan source = dragon(24).moved(motion);
    const RigidTransform truth = dragon_truth() * motion.inverse();
    const std::vector<PoseHypothesis> there = align(source, dragon(0));
    ASSERT_FALSE(there.empty());
    EXPECT_LT(apart(there[0].T_target_source, truth, source), 0.01) << "seed " << seed;
    EXPECT_GT(there[0].support, 100.0);
    const std::vector<PoseHypothesis> back = align(dragon(0), source);
    ASSERT_FALSE(back.empty());
    EXPECT_LT(apart(back[0].T_target_source, truth.inverse(), dragon(0)), 0.01) << "seed " << seed;
  }
}

TEST(CoarseAlignment, UnitsDoNotMatter) {
  const std::vector<PoseHypothesis> in_m = align(dragon(24), dragon(0));
  const RigidTransform none = RigidTransform::Identity();
  std::vector<PoseHypothesis> in_mm = align(dragon(24).moved(none, 1000.0), dragon(0).moved(none, 1000.0));
  ASSERT_FALSE(in_m.empty());
  ASSERT_FALSE(in_mm.empty());
  in_mm[0].T_target_source.translation() /= 1000.0;
  EXPECT_LT(apart(in_m[0].T_target_source, in_mm[0].T_target_source, dragon(24)), 1e-3);
  EXPECT_NEAR(in_m[0].support, in_mm[0].support, 0.02 * in_m[0].support);
}

TEST(CoarseAlignment, TurnsSurfacesOverOnlyWhenAsked) {
  Scan inside_out = dragon(24);
  for (Vec3& n : inside_out.normals) n = -n;
  const std::vector<PoseHypothesis> either = align(inside_out, dragon(0), {.same_side = false});
  ASSERT_FALSE(either.empty());
  EXPECT_LT(apart(either[0].T_target_source, dragon_truth(), dragon(24)), 0.01);
  for (const PoseHypothesis& pose : align(inside_out, dragon(0), {.same_side = true})) {
    EXPECT_GT(apart(pose.T_target_source, dragon_truth(), dragon(24)), 0.05);
  }
  const std::vector<PoseHypothesis> same = align(dragon(24), dragon(0), {.same_side = true});
  ASSERT_FALSE(same.empty());
  EXPECT_LT(apart(same[0].T_target_source, dragon_truth(), dragon(24)), 0.01);
}

TEST(CoarseAlignment, RanksDistinctPoses) {
  const std::vector<PoseHypothesis> poses = align(dragon(24), dragon(0));
  EXPECT_LE(poses.size(), 8U);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_GE(poses[i].support, 4.0);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(poses[j].support, poses[i].support);
      EXPECT_GT(apart(poses[i].T_target_source, poses[j].T_target_source, dragon(24)), 0.01);
    }
  }
  EXPECT_EQ(align(dragon(24), dragon(0), {.max_hypotheses = 1}).size(), 1U);
  EXPECT_THROW(static_cast<void>(align_coarsely({}, {}, {.max_hypotheses = 0})), InvalidInput);
}

TEST(CoarseAlignment, UnrelatedShapesFindLittleSupport) {
  const Geometry mesh = testing::read_data("meshes/armadillo.ply");
  const SurfaceGraph graph = build_graph(mesh).graph;
  Scan armadillo{graph.position, graph.normal, std::vector<Index>(graph.size())};
  std::iota(armadillo.keypoints.begin(), armadillo.keypoints.end(), Index{0});
  const double scale = bounding_box(dragon(0).positions).diagonal() / bounding_box(armadillo.positions).diagonal();
  for (const PoseHypothesis& pose : align(armadillo.moved(RigidTransform::Identity(), scale), dragon(0))) {
    EXPECT_LT(pose.support, 40.0);
  }
}

// Nothing determines a pose here: any answer will do that is a motion.
TEST(CoarseAlignment, SurvivesShapesWithoutFeatures) {
  for (const testing::Shape& shape :
       {testing::plane(40, 1.0, 0.2), testing::sphere(5, 1.0), testing::cylinder(60, 40, 1.0)}) {
    Scan scan{shape.positions, shape.normals, std::vector<Index>(shape.positions.size())};
    std::iota(scan.keypoints.begin(), scan.keypoints.end(), Index{0});
    for (const PoseHypothesis& pose : align(scan, scan.moved(random_motion(1)))) {
      EXPECT_TRUE(pose.T_target_source.matrix().allFinite()) << shape.name;
      EXPECT_NEAR(pose.T_target_source.linear().determinant(), 1.0, 1e-9) << shape.name;
    }
  }
}

TEST(CoarseAlignment, SurvivesTinyInput) {
  EXPECT_TRUE(align_coarsely({}, {}).empty());
  std::vector<Vec3> line;
  for (int i = 0; i < 30; ++i) line.emplace_back(i, 0, 0);
  Scan scan{line, std::vector<Vec3>(line.size(), Vec3::UnitZ()), {3, 7}};
  const RegistrationCloud cloud = scan.cloud();
  const DescribedPoints points = describe_points(cloud, scan.keypoints, 1.0);
  EXPECT_TRUE(align_coarsely(points, {}).empty());
  EXPECT_TRUE(align_coarsely({}, points).empty());
  for (const PoseHypothesis& pose : align_coarsely(points, points)) {
    EXPECT_TRUE(pose.T_target_source.matrix().allFinite());
  }
  scan.keypoints.resize(line.size());
  std::iota(scan.keypoints.begin(), scan.keypoints.end(), Index{0});
  for (const PoseHypothesis& pose : align(scan, scan)) EXPECT_TRUE(pose.T_target_source.matrix().allFinite());
}

TEST(CoarseAlignment, SameForAnyNumberOfThreads) {
  testing::expect_same_for_any_number_of_threads([](const RunContext& context) {
    std::vector<double> numbers;
    for (const PoseHypothesis& pose : align(dragon(24), dragon(0), {}, context)) {
      numbers.push_back(pose.support);
      const auto& m = pose.T_target_source.matrix();
      numbers.insert(numbers.end(), m.data(), m.data() + m.size());
    }
    return numbers;
  });
}

}  // namespace
}  // namespace shapelight
