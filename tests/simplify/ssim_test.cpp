#include "shapelight/simplify/ssim.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stop_token>

#include "shapelight/core/error.hpp"
#include "shapelight/metrics/surface_distance.hpp"
#include "shapelight/simplify/qslim.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"
#include "support/mesh_topology.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

using testing::Shape;
using testing::topology;

TriangleMesh as_mesh(const Shape& shape) { return {shape.positions, shape.triangles}; }

TriangleMesh read_mesh(const char* name) {
  const Geometry geometry = testing::read_data(name);
  return {geometry.positions, geometry.triangles};
}

// A smooth closed surface with large and small features.
TriangleMesh bumpy_sphere(int levels) {
  TriangleMesh mesh = as_mesh(testing::sphere(levels, 1.0));
  for (Vec3& p : mesh.positions) {
    p *= 1.0 + 0.1 * std::sin(5.0 * p.x()) * std::cos(4.0 * p.y()) + 0.03 * std::sin(17.0 * p.z());
  }
  return mesh;
}

double rms(const TriangleMesh& reference, const TriangleMesh& test) {
  return measure_surface_distance(reference, test).symmetric.rms;
}

class Ssim : public ::testing::TestWithParam<Placement> {
 protected:
  [[nodiscard]] SsimOptions options() const {
    SsimOptions options;
    options.placement = GetParam();
    return options;
  }
  [[nodiscard]] SimplifiedMesh simplify(const TriangleMesh& mesh, const SimplifyTarget& target,
                                        const RunContext& context = {}) const {
    return simplify_ssim(mesh, target, {}, options(), {}, context);
  }
};

INSTANTIATE_TEST_SUITE_P(, Ssim, ::testing::Values(Placement::Input, Placement::Optimal),
                         [](const auto& test) { return std::string(enum_name(test.param)); });

TEST_P(Ssim, CountsAreExact) {
  const TriangleMesh closed = bumpy_sphere(4), open = as_mesh(testing::saddle(40, 0.05, 0.2));
  for (const std::size_t count : {10UL, 123UL, 1000UL, 1281UL}) {
    EXPECT_EQ(simplify(closed, {.vertices = count}).mesh.positions.size(), count);
    EXPECT_EQ(simplify(open, {.vertices = count}).mesh.positions.size(), count);
    for (const TriangleMesh* mesh : {&closed, &open}) {
      const auto faces = static_cast<long>(simplify(*mesh, {.faces = 2 * count}).mesh.triangles.size());
      EXPECT_LE(std::abs(faces - static_cast<long>(2 * count)), 1) << count;
    }
  }
}

TEST_P(Ssim, TopologyStays) {
  const Shape torus = testing::torus(40, 20, 2.0, 0.7);
  const auto closed = topology(simplify(as_mesh(torus), {.vertices = 60}).mesh.triangles);
  EXPECT_TRUE(closed.is_manifold);
  EXPECT_EQ(closed.euler(), 0);
  EXPECT_EQ(closed.border_edges, 0U);
  const auto open = topology(simplify(as_mesh(testing::saddle(30, 0.05)), {.vertices = 60}).mesh.triangles);
  EXPECT_TRUE(open.is_manifold);
  EXPECT_EQ(open.euler(), 1);
  EXPECT_EQ(open.border_loops, 1U);
}

TEST_P(Ssim, ErrorIsFarBelowThatOfQuadrics) {
  const TriangleMesh mesh = bumpy_sphere(5);
  const SimplifyTarget target{.vertices = mesh.positions.size() / 10};
  QslimOptions qslim;
  qslim.placement = GetParam();
  const double quadrics = rms(mesh, simplify_qslim(mesh, target, qslim).mesh);
  EXPECT_LT(rms(mesh, simplify(mesh, target).mesh), 0.75 * quadrics);
}

TEST_P(Ssim, CreasesStay) {
  const TriangleMesh fandisk = read_mesh("meshes/fandisk.off");
  const SimplifyTarget target{.vertices = fandisk.positions.size() / 2};
  QslimOptions qslim;
  qslim.placement = GetParam();
  const SurfaceDistance ours = measure_surface_distance(fandisk, simplify(fandisk, target).mesh);
  const SurfaceDistance quadrics = measure_surface_distance(fandisk, simplify_qslim(fandisk, target, qslim).mesh);
  EXPECT_LE(ours.symmetric.rms, quadrics.symmetric.rms);
  EXPECT_LE(ours.normal_deviation.rms, quadrics.normal_deviation.rms + 0.002);
}

TEST_P(Ssim, SameForAnyNumberOfThreads) {
  const TriangleMesh mesh = bumpy_sphere(5);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const SimplifiedMesh result = simplify(mesh, {.vertices = 1000}, context);
    return std::pair(result.mesh.positions, result.mesh.triangles);
  });
}

TEST_P(Ssim, RatioOfOneChangesNothing) {
  const TriangleMesh mesh = bumpy_sphere(3);
  const SimplifiedMesh result = simplify(mesh, {.vertices = mesh.positions.size()});
  EXPECT_EQ(result.mesh.positions, mesh.positions);
  EXPECT_EQ(result.mesh.triangles, mesh.triangles);
}

TEST_P(Ssim, ResultDoesNotDependOnPlaceAndScale) {
  const TriangleMesh mesh = bumpy_sphere(4);
  TriangleMesh far = mesh;
  for (Vec3& p : far.positions) p = 1024.0 * p + Vec3(500000.0, 4000000.0, 0.0);  // metres in UTM
  const SimplifiedMesh here = simplify(mesh, {.vertices = 300}), there = simplify(far, {.vertices = 300});
  std::vector<Index> common;
  std::vector<Index> a = here.source_vertex, b = there.source_vertex;
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  EXPECT_GE(common.size(), 285U);
}

TEST_P(Ssim, CollapseBelowWhatTopologyAllowsIsRefused) {
  const TriangleMesh mesh = bumpy_sphere(2);
  try {
    (void)simplify(mesh, {.vertices = 3});
    FAIL() << "a closed surface of 3 vertices";
  } catch (const TargetUnreachable& error) {
    EXPECT_EQ(error.reachable(), 4U);
  }
}

TEST_P(Ssim, StopIsHeeded) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW((void)simplify(bumpy_sphere(4), {.vertices = 100}, {.stop = source.get_token()}), Cancelled);
}

TEST_P(Ssim, BadInputIsNamed) {
  const TriangleMesh mesh = bumpy_sphere(1);
  EXPECT_THROW((void)simplify(mesh, {}), InvalidInput);
  EXPECT_THROW((void)simplify(mesh, {.vertices = 10, .faces = 10}), InvalidInput);
  EXPECT_THROW((void)simplify({mesh.positions, {{0, 1, 99}}}, {.vertices = 3}), InvalidInput);
  TriangleMesh flat = mesh;
  for (Vec3& p : flat.positions) p = Vec3(1.0, 1.0, 1.0);
  EXPECT_THROW((void)simplify(flat, {.vertices = 10}), InvalidInput);
  const SimplifyTarget target{.vertices = 10};
  const std::vector<Index> no_vertex = {static_cast<Index>(mesh.positions.size())};
  const std::vector<Vec3> few(5, Vec3::Zero());
  EXPECT_THROW((void)simplify_ssim(mesh, target, {no_vertex, {}}, options()), InvalidInput);
  EXPECT_THROW((void)simplify_ssim(mesh, target, {{}, few}, options()), InvalidInput);
}

TEST(SsimInput, VerticesAreInputVerticesEachOnce) {
  const TriangleMesh mesh = bumpy_sphere(4);
  const SimplifiedMesh result = simplify_ssim(mesh, {.vertices = 400}, {});
  std::set<Index> distinct;
  for (std::size_t v = 0; v < 400; ++v) {
    EXPECT_EQ(result.mesh.positions[v], mesh.positions[result.source_vertex[v]]);
    distinct.insert(result.source_vertex[v]);
  }
  EXPECT_EQ(distinct.size(), 400U);
}

TEST(SsimInput, SamplesStayMoreOftenThanOthers) {
  const TriangleMesh mesh = bumpy_sphere(4);
  std::vector<Index> samples;
  for (Index v = 0; v < mesh.positions.size(); v += 4) samples.push_back(v);
  const auto kept = [&](std::span<const Index> guide) {
    SsimOptions options;
    options.sample_weight = 5.0;
    options.sweeps = 0;
    const SimplifiedMesh result = simplify_ssim(mesh, {.vertices = 640}, {.samples = guide, .denoised = {}}, options);
    return std::count_if(result.source_vertex.begin(), result.source_vertex.end(), [](Index v) { return v % 4 == 0; });
  };
  EXPECT_GT(kept(samples), kept({}) + 60);
}

TEST(SsimInput, UnderNoiseTheDenoisedSurfaceIsTheBetterMeasure) {
  const TriangleMesh clean = bumpy_sphere(5);
  TriangleMesh noisy = clean;
  for (std::size_t v = 0; v < clean.positions.size(); ++v) {
    for (int j = 0; j < 3; ++j) noisy.positions[v][j] += 0.006 * testing::gaussian(3, j, v);
  }
  const SimplifyTarget target{.vertices = clean.positions.size() / 10};
  const double plain = rms(clean, simplify_ssim(noisy, target, {}).mesh);
  const double guided = rms(clean, simplify_ssim(noisy, target, {.samples = {}, .denoised = clean.positions}).mesh);
  EXPECT_LT(guided, 0.8 * plain);
}

TEST(SsimInput, FeatureLinesStayLines) {
  const Shape shape = testing::plane(30, 0.1, 0.2);
  FeatureEdges seam;  // along row 15, from border to border
  for (Index c = 0; c + 1 < 30; ++c) seam.push_back({15 * 30 + c, 15 * 30 + c + 1});
  const SimplifiedMesh result = simplify_ssim(as_mesh(shape), {.vertices = 150}, {}, {}, seam);
  // What is left of the row still joins the two borders, by edges of the mesh.
  std::set<std::pair<Index, Index>> edges;
  for (const Triangle& t : result.mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      edges.insert(std::minmax(result.source_vertex[t[k]], result.source_vertex[t[(k + 1) % 3]]));
    }
  }
  std::vector<Index> row;
  for (const Index v : result.source_vertex) {
    if (v / 30 == 15) row.push_back(v);
  }
  std::sort(row.begin(), row.end());
  ASSERT_GE(row.size(), 2U);
  EXPECT_EQ(row.front(), 15U * 30U);
  EXPECT_EQ(row.back(), 15U * 30U + 29U);
  for (std::size_t i = 0; i + 1 < row.size(); ++i) EXPECT_TRUE(edges.contains({row[i], row[i + 1]})) << row[i];
}

TEST(SsimInput, RaggedBorderOfAScanStays) {
  const Geometry scan = testing::read_data("scans/bun000_quarter.rif");
  ASSERT_TRUE(scan.grid.has_value());
  TriangleMesh mesh{scan.positions, {}};
  for (Index r = 0; r + 1 < scan.grid->height; ++r) {
    for (Index c = 0; c + 1 < scan.grid->width; ++c) {
      const auto at = [&](Index dr, Index dc) { return scan.grid->pixel[(r + dr) * scan.grid->width + c + dc]; };
      const Index a = at(0, 0), b = at(0, 1), d = at(1, 0), e = at(1, 1);
      if (a == kNoIndex || b == kNoIndex || d == kNoIndex || e == kNoIndex) continue;
      mesh.triangles.insert(mesh.triangles.end(), {{a, d, b}, {b, d, e}});
    }
  }
  SsimOptions held, loose;
  loose.boundary_weight = 0.01;
  const SimplifyTarget target{.vertices = mesh.positions.size() / 10};
  const auto farthest = [&](const SsimOptions& options) {
    return measure_surface_distance(mesh, simplify_ssim(mesh, target, {}, options).mesh).forward.max;
  };
  EXPECT_LT(farthest(held), 0.7 * farthest(loose));
}

}  // namespace
}  // namespace shapelight
