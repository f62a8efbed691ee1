#include "shapelight/pipeline/sample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "shapelight/core/error.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

constexpr SamplingMethod kMethods[] = {SamplingMethod::Shape,  SamplingMethod::Random,   SamplingMethod::Voxel,
                                       SamplingMethod::Stratified, SamplingMethod::Farthest, SamplingMethod::Poisson,
                                       SamplingMethod::Normal, SamplingMethod::Covariance};
constexpr Preset kPresets[] = {Preset::Detail, Preset::Fast, Preset::Paper};
// A mesh, a range image, and clouds with and without colour; small ones, so that every method can be tried.
constexpr const char* kSmallFiles[] = {"meshes/fandisk.off", "scans/bun000_quarter.rif", "clouds/simple.las"};
constexpr const char* kFiles[] = {"meshes/bunny.ply", "meshes/fandisk.off", "scans/dragonStandRight_0.ply",
                                  "scans/bun000_quarter.rif", "clouds/simple.las", "clouds/room_scan1.pcd"};

SampleSize ratio(double r) { return {.count = {}, .ratio = r, .spacing = {}}; }
SampleSize count(std::uint64_t n) { return {.count = n, .ratio = {}, .spacing = {}}; }

SampleOptions with_method(SamplingMethod method) {
  SampleOptions options = sample_preset(Preset::Detail);
  options.method = method;
  return options;
}

void expect_subset(const std::vector<Index>& indices, const Geometry& geometry) {
  EXPECT_EQ(std::set<Index>(indices.begin(), indices.end()).size(), indices.size()) << "a point was chosen twice";
  for (const Index i : indices) {
    ASSERT_LT(i, geometry.size());
    EXPECT_TRUE(geometry.positions[i].allFinite());
  }
}

using Place = std::array<double, 3>;
std::vector<Place> places(const Geometry& geometry, const std::vector<Index>& indices) {
  std::vector<Place> result;
  for (const Index i : indices) {
    const Vec3& p = geometry.positions[i];
    result.push_back({p.x(), p.y(), p.z()});
  }
  std::sort(result.begin(), result.end());
  return result;
}

double jaccard(std::vector<Index> a, std::vector<Index> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  std::vector<Index> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return static_cast<double>(both.size()) / static_cast<double>(a.size() + b.size() - both.size());
}

TEST(Sample, EveryRatioIsExact) {
  for (const char* file : kFiles) {
    const Geometry geometry = read_data(file);
    std::size_t usable = 0;
    for (const Vec3& p : geometry.positions) usable += p.allFinite();
    for (const double r : {1e-9, 0.001, 0.05, 1.0 / 3.0, 1.0}) {
      SCOPED_TRACE(std::string(file) + " " + std::to_string(r));
      const SampleResult result = sample(geometry, ratio(r), sample_preset(Preset::Fast));
      EXPECT_EQ(result.usable, usable);
      EXPECT_EQ(result.indices.size(), std::max(1.0, std::round(r * static_cast<double>(usable))));
      expect_subset(result.indices, geometry);
    }
  }
}

TEST(Sample, EveryMethodAndPresetIsExact) {
  for (const char* file : kSmallFiles) {
    const Geometry geometry = read_data(file);
    for (const double r : {0.01, 0.1, 0.5, 1.0}) {
      for (const SamplingMethod method : kMethods) {
        SCOPED_TRACE(std::string(file) + " " + std::string(enum_name(method)));
        const SampleResult result = sample(geometry, ratio(r), with_method(method));
        EXPECT_EQ(result.indices.size(), std::llround(r * static_cast<double>(result.usable)));
        expect_subset(result.indices, geometry);
      }
      const SampleResult paper = sample(geometry, ratio(r), sample_preset(Preset::Paper));
      EXPECT_EQ(paper.indices.size(), std::llround(r * static_cast<double>(paper.usable)));
      expect_subset(paper.indices, geometry);
    }
  }
}

TEST(Sample, SmallerSamplesArePrefixesOfLargerOnes) {
  const Geometry geometry = read_data("scans/dragonStandRight_0.ply");
  const std::vector<Index> large = sample(geometry, count(5000)).indices;
  for (const std::uint64_t n : {1u, 10u, 500u, 4999u}) {
    const std::vector<Index> small = sample(geometry, count(n)).indices;
    EXPECT_TRUE(std::equal(small.begin(), small.end(), large.begin())) << n;
  }
}

TEST(Sample, SampleOfASampleIsStable) {
  for (const char* file : kSmallFiles) {
    const Geometry geometry = read_data(file);
    const std::vector<Index> indices = sample(geometry, ratio(0.3)).indices;
    EXPECT_EQ(sample(geometry, ratio(0.3)).indices, indices) << file << ": two runs differ";
    const Geometry chosen = select_points(geometry, indices);
    std::vector<Index> again = sample(chosen, ratio(1.0)).indices;
    std::sort(again.begin(), again.end());
    std::vector<Index> all(chosen.size());
    std::iota(all.begin(), all.end(), Index{0});
    EXPECT_EQ(again, all) << file;
  }
}

TEST(Sample, OrderOfTheInputDoesNotMatter) {
  for (const char* file : {"meshes/bunny.ply", "meshes/fandisk.off", "clouds/simple.las", "clouds/room_scan1.pcd"}) {
    const Geometry geometry = read_data(file);
    const std::vector<Index> order = random_order(geometry.size(), 5);
    const Geometry shuffled = reordered(geometry, order);
    for (const Preset preset : kPresets) {
      const auto a = places(geometry, sample(geometry, ratio(0.05), sample_preset(preset)).indices);
      const auto b = places(shuffled, sample(shuffled, ratio(0.05), sample_preset(preset)).indices);
      EXPECT_TRUE(a == b) << file << " " << enum_name(preset);
    }
  }
  const Geometry geometry = read_data("meshes/fandisk.off");
  const Geometry shuffled = reordered(geometry, random_order(geometry.size(), 5));
  for (const SamplingMethod method : kMethods) {
    EXPECT_TRUE(places(geometry, sample(geometry, ratio(0.05), with_method(method)).indices) ==
                places(shuffled, sample(shuffled, ratio(0.05), with_method(method)).indices))
        << enum_name(method);
  }
}

TEST(Sample, UnitsDoNotMatter) {
  for (const char* file : kSmallFiles) {
    const Geometry geometry = read_data(file);
    // A power of two is exact in every step; a thousand rounds.
    for (const double scale : {1024.0, 1000.0}) {
      const Geometry scaled = transformed(geometry, scale * Eigen::Matrix3d::Identity());
      for (const Preset preset : kPresets) {
        const auto a = sample(geometry, ratio(0.1), sample_preset(preset)).indices;
        const auto b = sample(scaled, ratio(0.1), sample_preset(preset)).indices;
        const double same = jaccard(a, b);
        if (scale == 1024.0) {
          EXPECT_EQ(a, b) << file << " " << enum_name(preset);
        } else {
          if (same < 1.0) std::printf("%s %s x1000: Jaccard %.4f\n", file, std::string(enum_name(preset)).c_str(), same);
          // The literal shape index is 0/0 where the surface is flat, so that rounding decides some of the paper's points.
          EXPECT_GE(same, preset == Preset::Paper ? 0.85 : 1.0) << file << " " << enum_name(preset);
        }
      }
    }
  }
}

TEST(Sample, RotationKeepsTheSet) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  for (const char* file : {"meshes/bunny.ply", "meshes/armadillo.ply", "meshes/fandisk.off", "clouds/simple.las"}) {
    const Geometry geometry = read_data(file);
    const Geometry turned = transformed(geometry, rotation);
    const double same = jaccard(sample(geometry, ratio(0.05)).indices, sample(turned, ratio(0.05)).indices);
    std::printf("%s rotated: Jaccard %.4f\n", file, same);
    EXPECT_GE(same, 0.99) << file;
  }
}

TEST(Sample, FarFromTheOriginIsTheSame) {
  const Geometry geometry = read_data("scans/bun000_quarter.rif");
  const Geometry far = transformed(geometry, Eigen::Matrix3d::Identity(), Vec3(1048576.0, -524288.0, 4096.0));
  EXPECT_GE(jaccard(sample(geometry, ratio(0.1)).indices, sample(far, ratio(0.1)).indices), 0.95);
}

TEST(Sample, ThreadsDoNotMatter) {
  for (const char* file : {"meshes/fandisk.off", "scans/dragonStandRight_0.ply", "clouds/simple.las"}) {
    const Geometry geometry = read_data(file);
    for (const Preset preset : kPresets) {
      SCOPED_TRACE(std::string(file) + " " + std::string(enum_name(preset)));
      expect_same_for_any_number_of_threads([&](const RunContext& context) {
        return sample(geometry, ratio(0.05), sample_preset(preset), context).indices;
      });
    }
  }
  const Geometry geometry = read_data("meshes/fandisk.off");
  for (const SamplingMethod method : kMethods) {
    SCOPED_TRACE(std::string(enum_name(method)));
    expect_same_for_any_number_of_threads(
        [&](const RunContext& context) { return sample(geometry, ratio(0.2), with_method(method), context).indices; });
  }
}

TEST(Sample, SkippedBoundaryPointsAreNeverChosen) {
  for (const char* file : {"scans/dragonStandRight_0.ply", "scans/bun000_quarter.rif", "clouds/simple.las"}) {
    const Geometry geometry = read_data(file);
    const BuiltGraph built = build_graph(geometry);
    for (const SamplingMethod method : kMethods) {
      SampleOptions options = with_method(method);
      options.skip_boundary = true;
      for (const Index i : sample(geometry, ratio(0.2), options).indices) {
        ASSERT_FALSE(built.graph.boundary[built.graph.vertex_of_point[i]]) << file << " " << enum_name(method);
      }
    }
  }
}

TEST(Sample, SaysHowManyCanBeReached) {
  const Geometry geometry = read_data("scans/bun000_quarter.rif");
  const auto reachable = [&](const SampleSize& size, const SampleOptions& options) -> std::uint64_t {
    try {
      (void)sample(geometry, size, options);
    } catch (const TargetUnreachable& error) {
      EXPECT_NE(std::string(error.what()).find(std::to_string(error.reachable())), std::string::npos) << error.what();
      return error.reachable();
    }
    return 0;
  };
  SampleOptions options;
  EXPECT_EQ(reachable(count(1000000), options), sample(geometry, ratio(1.0)).indices.size());
  options.skip_boundary = true;
  const std::uint64_t inner = reachable(ratio(1.0), options);
  ASSERT_GT(inner, 0u);
  EXPECT_EQ(sample(geometry, count(inner), options).indices.size(), inner);
}

TEST(Sample, FlaggedStraysAndDuplicatesComeLast) {
  Geometry geometry = as_cloud(read_data("meshes/fandisk.off"));
  const std::size_t clean = geometry.size();
  const double size = bounding_box(geometry.positions).diagonal();
  for (int i = 0; i < 20; ++i) {
    geometry.positions.push_back(size * Vec3(2.0 + random01(1, 0, i), random01(1, 1, i), 2.0 * random01(1, 2, i)));
  }
  for (Index i = 0; i < 30; ++i) geometry.positions.push_back(geometry.positions[100 * i]);
  geometry.positions.emplace_back(std::nan(""), 0.0, 0.0);
  const BuiltGraph built = build_graph(geometry);
  ASSERT_EQ(built.diagnostics.duplicate_points, 30u);
  ASSERT_GE(built.diagnostics.outliers, 15u);
  const SampleResult all = sample(geometry, ratio(1.0));
  ASSERT_EQ(all.indices.size(), clean + 50);
  EXPECT_EQ(all.candidates, clean + 20 - built.diagnostics.outliers);
  EXPECT_EQ(all.last_resort, 30 + built.diagnostics.outliers);
  for (std::size_t rank = 0; rank < all.candidates; ++rank) {
    const Index i = all.indices[rank];
    EXPECT_FALSE(built.graph.outlier[built.graph.vertex_of_point[i]]);
    EXPECT_EQ(built.graph.global_id[built.graph.vertex_of_point[i]], i) << "a duplicate came early";
  }
  EXPECT_EQ(sample(geometry, ratio(0.5)).last_resort, 0u);
}

TEST(Sample, SpacingBoundsTheGaps) {
  const Geometry geometry = read_data("meshes/fandisk.off");
  const double spacing = 0.03 * bounding_box(geometry.positions).diagonal();
  for (const SamplingMethod method : {SamplingMethod::Shape, SamplingMethod::Farthest, SamplingMethod::Poisson}) {
    const auto indices = sample(geometry, {.count = {}, .ratio = {}, .spacing = spacing}, with_method(method)).indices;
    for (const Vec3& p : geometry.positions) {
      double nearest = HUGE_VAL;
      for (const Index i : indices) nearest = std::min(nearest, (geometry.positions[i] - p).norm());
      ASSERT_LE(nearest, spacing * (1.0 + 1e-12)) << enum_name(method);
    }
  }
}

TEST(Sample, SizesAndOptionsAreChecked) {
  const Geometry geometry = read_data("clouds/simple.las");
  const double nan = std::nan("");
  for (const SampleSize& bad : {SampleSize{}, count(0), ratio(0.0), ratio(1.5), ratio(-0.1), ratio(nan),
                                SampleSize{.count = 5, .ratio = 0.5, .spacing = {}},
                                SampleSize{.count = {}, .ratio = {}, .spacing = 0.0},
                                SampleSize{.count = {}, .ratio = {}, .spacing = HUGE_VAL}}) {
    EXPECT_THROW((void)sample(geometry, bad), InvalidInput);
  }
  SampleOptions options;
  options.local_weight = 2.0;
  EXPECT_THROW((void)sample(geometry, ratio(0.5), options), InvalidInput);
  options = {};
  options.fields.graph.neighbors = 0;
  EXPECT_THROW((void)sample(geometry, ratio(0.5), options), InvalidInput);
  EXPECT_THROW((void)sample(geometry, {.count = {}, .ratio = {}, .spacing = 1.0}, sample_preset(Preset::Paper)), InvalidInput);
}

// What every method and preset does with next to nothing.
class FewPoints : public ::testing::TestWithParam<SamplingMethod> {};

TEST_P(FewPoints, EveryPointCanBeChosen) {
  std::vector<Vec3> collinear, lattice;
  for (int i = 0; i < 50; ++i) {
    collinear.emplace_back(0.1 * i, 0.2 * i, 0.0);
    lattice.emplace_back(i % 7, i / 7, 0.0);
  }
  const double nan = std::nan("");
  const std::vector<std::vector<Vec3>> cases = {{{1, 2, 3}},
                                                {{1, 2, 3}, {4, 5, 6}},
                                                {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                                std::vector<Vec3>(40, Vec3(1, 2, 3)),
                                                collinear,
                                                lattice,
                                                {{nan, 0, 0}, {1, 2, 3}, {0, HUGE_VAL, 0}}};
  for (std::size_t c = 0; c < cases.size(); ++c) {
    Geometry geometry;
    geometry.positions = cases[c];
    std::size_t usable = 0;
    for (const Vec3& p : geometry.positions) usable += p.allFinite();
    for (const std::size_t n : std::set<std::size_t>{1, (usable + 1) / 2, usable}) {
      for (const Preset preset : {Preset::Detail, Preset::Paper}) {
        SCOPED_TRACE("case " + std::to_string(c) + ", " + std::to_string(n));
        SampleOptions options = sample_preset(preset);
        options.method = GetParam();
        try {
          const std::vector<Index> indices = sample(geometry, count(n), options).indices;
          EXPECT_EQ(indices.size(), n);
          expect_subset(indices, geometry);
        } catch (const InvalidInput& error) {
          // Methods that look at normals cannot work where there are none; they say so.
          EXPECT_TRUE(GetParam() == SamplingMethod::Normal || GetParam() == SamplingMethod::Covariance) << error.what();
          EXPECT_NE(std::string(error.what()).find("normal"), std::string::npos) << error.what();
        }
      }
    }
  }
}

TEST_P(FewPoints, NothingUsableReachesNothing) {
  Geometry empty, lost;
  lost.positions = {Vec3(std::nan(""), 0, 0), Vec3(0, HUGE_VAL, 0)};
  for (const Geometry& geometry : {empty, lost}) {
    try {
      (void)sample(geometry, count(1), with_method(GetParam()));
      FAIL() << "chose a point of nothing";
    } catch (const TargetUnreachable& error) {
      EXPECT_EQ(error.reachable(), 0u);
    }
    EXPECT_THROW((void)sample(geometry, ratio(0.5), with_method(GetParam())), TargetUnreachable);
  }
}

std::string method_name(const ::testing::TestParamInfo<SamplingMethod>& info) { return std::string(enum_name(info.param)); }
INSTANTIATE_TEST_SUITE_P(Methods, FewPoints, ::testing::ValuesIn(kMethods), method_name);

}  // namespace
}  // namespace shapelight
