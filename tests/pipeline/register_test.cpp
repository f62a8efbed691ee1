#include "shapelight/pipeline/register.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/io/transform.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"
#include "support/random_points.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

using testing::read_data;

double degrees_between(const RigidTransform& a, const RigidTransform& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180.0 / std::numbers::pi;
}

RigidTransform turn(double degrees, const Vec3& axis, const Vec3& shift = Vec3::Zero()) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized()).toRotationMatrix();
  T.translation() = shift;
  return T;
}

// Two scans of the Stanford dragon, 24 degrees apart.
struct Dragon {
  Geometry source = read_data("scans/dragonStandRight_24.ply");
  Geometry target = read_data("scans/dragonStandRight_0.ply");
  RigidTransform truth = read_transform(SHAPELIGHT_DATA_DIR "/scans/T_dragonStandRight_24_to_0.txt");
};
const Dragon& dragon() {
  static const Dragon loaded;
  return loaded;
}

class EveryMethod : public ::testing::TestWithParam<RegistrationMethod> {};
INSTANTIATE_TEST_SUITE_P(Register, EveryMethod,
                         ::testing::Values(RegistrationMethod::Ficp, RegistrationMethod::FicpPure,
                                           RegistrationMethod::SoftIcp, RegistrationMethod::Icp,
                                           RegistrationMethod::Plane, RegistrationMethod::Gicp),
                         [](const auto& param) {
                           std::string name(enum_name(param.param));
                           std::erase(name, '-');
                           return name;
                         });

// The published truth is good to about 0.1 degree.
TEST_P(EveryMethod, FindsTheDragonFromANearbyStart) {
  RegisterOptions options;
  options.method = GetParam();
  const RigidTransform start = turn(8.0, {1, 2, 3}, {0.002, -0.001, 0.001}) * dragon().truth;
  const RegisterResult result = register_scans(dragon().source, dragon().target, start, options);
  EXPECT_LT(degrees_between(result.T_target_source, dragon().truth), 0.2);
  EXPECT_GT(result.assessment.confidence, 0.5);
  EXPECT_GT(result.assessment.overlap, 0.8);
  EXPECT_EQ(result.hypotheses, 0u);
}

// However the scans lie in their files, the motion between them is found, and it composes with how they were moved.
TEST(Register, FindsTheDragonWithoutAStartWhereverItLies) {
  const RigidTransform move_source = turn(140.0, {1, -1, 0.3}, {3.0, -2.0, 5.0});
  const RigidTransform move_target = turn(70.0, {0.2, 1, 0.5}, {100.0, 50.0, -70.0});
  Geometry source = dragon().source;
  Geometry target = dragon().target;
  transform_geometry(source, move_source);
  transform_geometry(target, move_target);
  const RegisterResult result = register_scans(source, target);
  const RigidTransform truth = move_target * dragon().truth * move_source.inverse();
  EXPECT_LT(degrees_between(result.T_target_source, truth), 0.2);
  const Vec3 middle = bounding_box(source.positions).center();
  EXPECT_LT((result.T_target_source * middle - truth * middle).norm(), 0.002);
  EXPECT_GT(result.assessment.confidence, 0.5);
  EXPECT_GT(result.hypotheses, 0u);
}

TEST(Register, UnitsDoNotMatter) {
  Geometry source = dragon().source;
  Geometry target = dragon().target;
  for (Vec3& p : source.positions) p *= 1000.0;
  for (Vec3& p : target.positions) p *= 1000.0;
  RigidTransform start = turn(8.0, {1, 2, 3}, {0.002, -0.001, 0.001}) * dragon().truth;
  const RegisterResult small = register_scans(dragon().source, dragon().target, start);
  start.translation() *= 1000.0;
  const RegisterResult large = register_scans(source, target, start);
  EXPECT_LT(degrees_between(small.T_target_source, large.T_target_source), 1e-3);
  EXPECT_NEAR(large.assessment.reciprocal.mean, 1000.0 * small.assessment.reciprocal.mean, 0.01);
  EXPECT_NEAR(large.assessment.confidence, small.assessment.confidence, 1e-3);
}

// Shapes that do not tell where they are; scans of different things.
TEST(Register, DoubtsWhatCannotBeKnown) {
  const auto geometry_of = [](const testing::Shape& shape) {
    Geometry geometry;
    geometry.positions = shape.positions;
    geometry.triangles = shape.triangles;
    return geometry;
  };
  const auto expect_doubt = [](const Geometry& source, const Geometry& target, const char* what) {
    const RegisterResult result = register_scans(source, target);
    EXPECT_LT(result.assessment.confidence, 0.5) << what;
    EXPECT_FALSE(result.assessment.doubt.empty()) << what;
  };
  const Geometry sphere = geometry_of(testing::sphere(5, 1.0));
  expect_doubt(sphere, sphere, "sphere");
  const Geometry plane = geometry_of(testing::plane(60, 0.1));
  expect_doubt(plane, plane, "plane");
  const Geometry torus = geometry_of(testing::torus(120, 60, 1.0, 0.4));
  expect_doubt(torus, torus, "torus");
  expect_doubt(torus, dragon().target, "torus on a dragon");
  expect_doubt(read_data("meshes/fandisk.off"), dragon().target, "fandisk on a dragon");
}

TEST(Register, RefusesWhatIsNoScan) {
  const Geometry good = dragon().target;
  Geometry bad;
  EXPECT_THROW((void)register_scans(bad, good), FormatError);
  bad.positions.assign(5, Vec3(1, 2, 3));
  EXPECT_THROW((void)register_scans(bad, good), FormatError);
  bad.positions.assign(1000, Vec3(1, 2, 3));  // one place
  EXPECT_THROW((void)register_scans(bad, good), FormatError);
  bad.positions.assign(1000, Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_THROW((void)register_scans(good, bad), FormatError);
}

// A line of points has no surface: never a pose that looks good.
TEST(Register, DoubtsCollinearAndPlanarPoints) {
  Geometry line, sheet;
  for (int i = 0; i < 400; ++i) line.positions.push_back({0.1 * i, 0.0, 0.0});
  for (const Vec3& p : test::random_points(2000, 3)) sheet.positions.push_back({p.x(), p.y(), 0.0});
  for (const Geometry* cloud : {&line, &sheet}) {
    double confidence = 0.0;
    try {
      confidence = register_scans(*cloud, *cloud).assessment.confidence;
    } catch (const FormatError&) {
      continue;  // as good an answer
    }
    EXPECT_LT(confidence, 0.5);
  }
}

class EverySampler : public ::testing::TestWithParam<SamplingMethod> {};
INSTANTIATE_TEST_SUITE_P(Register, EverySampler,
                         ::testing::Values(SamplingMethod::Shape, SamplingMethod::Random, SamplingMethod::Voxel,
                                           SamplingMethod::Stratified, SamplingMethod::Farthest,
                                           SamplingMethod::Poisson, SamplingMethod::Normal, SamplingMethod::Covariance),
                         [](const auto& param) { return std::string(enum_name(param.param)); });

TEST_P(EverySampler, ThinsBothScansToTheShareAskedFor) {
  RegisterOptions options;
  options.sampler = GetParam();
  options.ratio = 0.05;
  options.method = RegistrationMethod::Gicp;
  const RegisterResult result = register_scans(dragon().source, dragon().target, dragon().truth, options);
  EXPECT_NEAR(static_cast<double>(result.source_samples), 0.05 * 34836, 3.0);
  EXPECT_NEAR(static_cast<double>(result.target_samples), 0.05 * 41841, 3.0);
  EXPECT_LT(degrees_between(result.T_target_source, dragon().truth), 0.3);
}

TEST(Register, SameForAnyNumberOfThreads) {
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const RegisterResult result = register_scans(dragon().source, dragon().target, {}, {}, context);
    const Eigen::Matrix4d T = result.T_target_source.matrix();
    std::vector<double> numbers(T.data(), T.data() + 16);
    numbers.push_back(result.assessment.confidence);
    numbers.push_back(result.rival_fit);
    return numbers;
  });
}

TEST(Register, StopsWhenAskedTo) {
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  int calls = 0;
  context.progress = [&](double, std::string_view) { stop.request_stop(), ++calls; };
  EXPECT_THROW((void)register_scans(dragon().source, dragon().target, {}, {}, context), Cancelled);
  EXPECT_LE(calls, 3);
}

TEST(Register, ProgressRisesToOne) {
  double last = 0.0;
  RunContext context;
  context.progress = [&](double fraction, std::string_view) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  (void)register_scans(dragon().source, dragon().target, {}, {}, context);
  EXPECT_DOUBLE_EQ(last, 1.0);
}

}  // namespace
}  // namespace shapelight
