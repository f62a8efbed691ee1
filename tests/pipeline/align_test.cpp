#include "shapelight/pipeline/align.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapelight/core/error.hpp"
#include "shapelight/spatial/triangle_tree.hpp"
#include "shapelight/synthetic/virtual_scan.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"

// Many scans into one frame: virtual scans, whose poses are known exactly.
namespace shapelight {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Views {
  std::vector<Geometry> scans;
  std::vector<RigidTransform> T_mesh_scan;

  void add(VirtualScan scan) {
    scans.push_back(std::move(scan.geometry));
    T_mesh_scan.push_back(scan.T_mesh_scan);
  }
};

// Scans of a mesh from all around, each in a random frame.
Views views_of(const char* mesh_name, int count, int from = 0, int to = 1000, double noise = 0.0005) {
  const Geometry mesh = testing::read_data(mesh_name);
  const TriangleTree surface({mesh.positions, mesh.triangles});
  const auto cameras = ring_of_cameras(bounding_sphere(mesh.positions), count, 0.3, 0.25);
  VirtualScanOptions options;
  options.width = options.height = 120;
  options.noise = noise * bounding_box(mesh.positions).diagonal();
  options.random_pose = true;
  Views views;
  for (int i = from; i < std::min(to, count); ++i) {
    options.seed = static_cast<std::uint64_t>(i);
    views.add(virtual_scan(surface, cameras[static_cast<std::size_t>(i)], options));
  }
  return views;
}

// [degrees] largest error of the scans in group 0 against their first one.
double largest_angle(const AlignResult& result, const Views& views) {
  double largest = 0.0;
  std::size_t first = 0;
  while (result.scans[first].group != 0) ++first;
  for (std::size_t i = 0; i < views.scans.size(); ++i) {
    if (result.scans[i].group != 0) continue;
    const RigidTransform truth = views.T_mesh_scan[first].inverse() * views.T_mesh_scan[i];
    const RigidTransform off = truth.inverse() * result.scans[i].T_world_scan;
    largest = std::max(largest, Eigen::AngleAxisd(off.linear()).angle());
  }
  return largest / kDegree;
}

AlignOptions quick() {
  AlignOptions options;
  options.registration.ratio = 0.2;
  return options;
}

TEST(AlignScans, PlacesViewsFromAllAround) {
  const Views views = views_of("meshes/bunny.ply", 7);
  const AlignResult result = align_scans(views_of(views.scans), quick());
  EXPECT_TRUE(result.all_placed());
  EXPECT_EQ(result.num_groups, 1u);
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_LT(largest_angle(result, views), 0.2);
  EXPECT_TRUE(result.scans[0].T_world_scan.matrix() == Eigen::Matrix4d::Identity());
  for (std::size_t i = 0; i < 7; ++i) {
    const auto& partners = result.scans[i].partners;
    EXPECT_TRUE(std::find(partners.begin(), partners.end(), (i + 1) % 7) != partners.end()) << "the loop is closed";
    EXPECT_GT(result.scans[i].rms, 0.0);
    EXPECT_LT(result.scans[i].rms, 0.0004) << "three times the noise";
  }
  for (const AlignedPair& pair : result.pairs) {
    EXPECT_LT(pair.target, pair.source);
    if (pair.graph.use != EdgeUse::Used) continue;
    EXPECT_GE(pair.registration_confidence, 0.5);
    EXPECT_LT(pair.graph.disagreement.rotation, 3.0 * kDegree);
  }
}

TEST(AlignScans, TwoScansAreARegistration) {
  const Views views = views_of("meshes/bunny.ply", 12, 0, 2);
  const AlignResult result = align_scans(views_of(views.scans), quick());
  ASSERT_TRUE(result.all_placed());
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].graph.use, EdgeUse::Used);
  EXPECT_LT(largest_angle(result, views), 0.3);
  AlignOptions plain = quick();
  plain.refine = false;
  const AlignResult unrefined = align_scans(views_of(views.scans), plain);
  EXPECT_TRUE(unrefined.scans[1].T_world_scan.isApprox(unrefined.pairs[0].T_target_source, 1e-9));
  const RegisterResult pair = register_scans(views.scans[1], views.scans[0], {}, plain.registration);
  EXPECT_TRUE(unrefined.scans[1].T_world_scan.isApprox(pair.T_target_source, 1e-9));
}

// Two objects in one call: each has a group, nothing is placed on the other.
TEST(AlignScans, StrangersStayApart) {
  Views views = views_of("meshes/bunny.ply", 12, 0, 3);
  const Views others = views_of("meshes/armadillo.ply", 12, 0, 2);
  views.scans.insert(views.scans.begin(), others.scans.begin(), others.scans.end());
  views.T_mesh_scan.insert(views.T_mesh_scan.begin(), others.T_mesh_scan.begin(), others.T_mesh_scan.end());
  const AlignResult result = align_scans(views_of(views.scans), quick());
  EXPECT_FALSE(result.all_placed());
  EXPECT_EQ(result.num_placed, 3u);
  for (const std::size_t i : {2, 3, 4}) EXPECT_EQ(result.scans[i].group, 0u);
  for (const std::size_t i : {0, 1}) EXPECT_NE(result.scans[i].group, 0u);
  EXPECT_TRUE(result.scans[2].T_world_scan.matrix() == Eigen::Matrix4d::Identity()) << "the world";
  EXPECT_LT(largest_angle(result, views), 0.3);
  EXPECT_EQ(result.warnings.size(), 2u);
  const Geometry merged = merge_scans(views.scans, result);
  EXPECT_EQ(merged.size(), views.scans[2].size() + views.scans[3].size() + views.scans[4].size());
}

TEST(AlignScans, InSequenceOnlyNeighboursAndLoops) {
  const Views views = views_of("meshes/bunny.ply", 7);
  AlignOptions options = quick();
  options.sequence = true;
  const AlignResult result = align_scans(views_of(views.scans), options);
  EXPECT_TRUE(result.all_placed());
  EXPECT_LT(largest_angle(result, views), 0.2);
  bool has_closed = false;
  for (const AlignedPair& pair : result.pairs) {
    EXPECT_EQ(pair.closes_loop, pair.source != pair.target + 1) << pair.target << " " << pair.source;
    has_closed = has_closed || (pair.target == 0 && pair.source == 6);
  }
  EXPECT_TRUE(has_closed) << "the last scan and the first";
}

TEST(AlignScans, UnitsAndLargeOffsetsDoNotMatter) {
  const Views views = views_of("meshes/bunny.ply", 12, 0, 3);
  const AlignResult metres = align_scans(views_of(views.scans), quick());
  std::vector<Geometry> moved;
  const Vec3 far(500000.0, 5000000.0, 200.0);
  for (const Geometry& scan : views.scans) {
    moved.push_back(testing::transformed(scan, 1000.0 * Eigen::Matrix3d::Identity(), far));
  }
  const AlignResult millimetres = align_scans(views_of(moved), quick());
  ASSERT_TRUE(metres.all_placed());
  ASSERT_TRUE(millimetres.all_placed());
  for (std::size_t i = 0; i < 3; ++i) {
    const RigidTransform& a = metres.scans[i].T_world_scan;
    const RigidTransform& b = millimetres.scans[i].T_world_scan;
    const Vec3& p = views.scans[i].positions.front();
    EXPECT_LT((1000.0 * (a * p) + far - b * moved[i].positions.front()).norm(), 0.02) << "of 150 mm";
  }
}

TEST(AlignScans, SameForAnyNumberOfThreads) {
  const Views views = views_of("meshes/bunny.ply", 12, 0, 3);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    std::vector<double> numbers;
    const AlignResult result = align_scans(views_of(views.scans), quick(), context);
    for (const AlignedScan& scan : result.scans) {
      numbers.insert(numbers.end(), scan.T_world_scan.data(), scan.T_world_scan.data() + 16);
      numbers.push_back(scan.rms);
    }
    for (const AlignedPair& pair : result.pairs) numbers.push_back(pair.graph.confidence);
    return numbers;
  });
}

TEST(AlignScans, ProgressIsMonotoneAndCancels) {
  const Views views = views_of("meshes/bunny.ply", 12, 0, 2);
  double last = 0.0;
  RunContext context;
  context.progress = [&](double fraction, std::string_view) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  (void)align_scans(views_of(views.scans), quick(), context);
  EXPECT_EQ(last, 1.0);
  std::stop_source stop;
  context = {0, stop.get_token(), [&](double fraction, std::string_view) {
               if (fraction > 0.5) stop.request_stop();
             }};
  EXPECT_THROW((void)align_scans(views_of(views.scans), quick(), context), Cancelled);
}

TEST(AlignScans, RefusesWhatMakesNoSense) {
  Views views = views_of("meshes/bunny.ply", 12, 0, 1);
  EXPECT_THROW((void)align_scans(views_of(views.scans), {}), InvalidInput);
  views.scans.push_back({});
  try {
    (void)align_scans(views_of(views.scans), {});
    ADD_FAILURE() << "accepted";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("scan 1"), std::string::npos) << error.what();
  }
  AlignOptions beyond;
  beyond.min_confidence = 1.5;
  EXPECT_THROW((void)align_scans(views_of(views.scans), beyond), InvalidInput);
}

TEST(MergeScans, KeepsWhatAllHaveAndSaysWhere) {
  std::vector<Geometry> scans(3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = static_cast<double>(i);
    scans[i].positions = {{x, 0, 0}, {x, std::nan(""), 0}, {x, 1, 0}};
    scans[i].coordinate_type = ScalarType::Float32;
    scans[i].attributes.set({"intensity", std::vector<float>{1.0F, 2.0F, 3.0F}});
  }
  scans[1].attributes.set({"nx", std::vector<float>{1, 1, 1}});
  scans[2].attributes.set({"intensity", std::vector<double>{1, 2, 3}});
  AlignResult aligned;
  aligned.scans.resize(3);
  aligned.scans[1].T_world_scan.translation() = Vec3(0, 0, 7);
  aligned.scans[2].group = 1;
  const Geometry merged = merge_scans(scans, aligned);
  EXPECT_EQ(merged.positions, (std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}, {1, 0, 7}, {1, 1, 7}}));
  EXPECT_EQ(merged.attributes.find("scan")->to_doubles(), (std::vector<double>{0, 0, 1, 1}));
  EXPECT_EQ(merged.attributes.find("intensity")->to_doubles(), (std::vector<double>{1, 3, 1, 3}));
  EXPECT_EQ(merged.attributes.find("nx"), nullptr);
  EXPECT_EQ(merged.coordinate_type, ScalarType::Float32);
  aligned.scans[2].group = 0;
  EXPECT_EQ(merge_scans(scans, aligned).attributes.find("intensity"), nullptr) << "of another type";
  aligned.scans.resize(2);
  EXPECT_THROW((void)merge_scans(scans, aligned), InvalidInput);
}

}  // namespace
}  // namespace shapelight
