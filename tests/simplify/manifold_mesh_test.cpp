#include "simplify/manifold_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/mesh_topology.hpp"
#include "support/shapes.hpp"

namespace shapelight::simplification {
namespace {

using shapelight::testing::Shape;
using shapelight::testing::Topology;
using shapelight::testing::topology;

struct Made {
  ManifoldMesh mesh;
  MeshOddities met;
};

Made make(const TriangleMesh& mesh, const FeatureEdges& features = {}) {
  Made made;
  made.mesh = make_manifold(mesh, features, {}, &made.met);
  return made;
}

TriangleMesh as_mesh(const Shape& shape) { return {shape.positions, shape.triangles}; }

// Vertices spread over a curve that no three of them share a line of.
TriangleMesh faces_over_curve(std::size_t n, std::vector<Triangle> triangles) {
  TriangleMesh mesh;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i);
    mesh.positions.emplace_back(t, t * t, t * t * t);
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

void expect_sound(const ManifoldMesh& mesh) {
  const Topology t = topology(mesh.mesh);
  EXPECT_TRUE(t.is_manifold);
  EXPECT_EQ(t.repeated_faces, 0u);
  const std::size_t n = mesh.mesh.positions.size();
  EXPECT_EQ(t.vertices, n) << "every vertex is used";
  ASSERT_EQ(mesh.source.size(), n);
  ASSERT_EQ(mesh.locked.size(), n);
  ASSERT_EQ(mesh.line.size(), n);
  EXPECT_TRUE(std::ranges::is_sorted(mesh.source));
  const auto edges = shapelight::testing::directed_edges(mesh.mesh.triangles);
  for (Index v = 0; v < n; ++v) {
    for (const Index w : mesh.line[v]) {
      if (w == kNoIndex) continue;
      EXPECT_FALSE(mesh.locked[v]);
      EXPECT_TRUE(edges.contains({v, w}) || edges.contains({w, v})) << "a line runs along edges";
      // Lines are mutual, unless they end at a corner.
      EXPECT_TRUE(mesh.locked[w] || mesh.line[w][0] == v || mesh.line[w][1] == v);
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto [a, b] = edge;
    if (edges.contains({b, a})) continue;
    for (const auto& [v, w] : {std::pair(a, b), std::pair(b, a)}) {
      EXPECT_TRUE(mesh.locked[v] || mesh.line[v][0] == w || mesh.line[v][1] == w) << "borders are lines";
    }
  }
}

TEST(MakeManifold, PassesAManifoldThrough) {
  for (const Shape& shape : {testing::sphere(2, 1.0), testing::torus(12, 8, 2.0, 0.5), testing::cylinder(9, 5, 1.0),
                             testing::plane(6, 1.0)}) {
    const auto [mesh, met] = make(as_mesh(shape));
    expect_sound(mesh);
    EXPECT_EQ(mesh.mesh.triangles, shape.triangles) << shape.name;
    EXPECT_EQ(mesh.mesh.positions, shape.positions);
    EXPECT_EQ(std::ranges::count(mesh.locked, 1), 0);
    EXPECT_EQ(met.split_vertices + met.degenerate_faces + met.duplicate_faces + met.reoriented_faces +
                  met.unused_vertices + met.locked_vertices,
              0u);
  }
}

TEST(MakeManifold, LeavesOutUnusedVerticesAndOddFaces) {
  const auto [mesh, met] = make(faces_over_curve(6, {{1, 2, 3}, {1, 1, 2}, {3, 1, 2}, {2, 1, 3}, {3, 2, 5}}));
  expect_sound(mesh);
  EXPECT_EQ(mesh.source, (std::vector<Index>{1, 2, 3, 5}));
  EXPECT_EQ(mesh.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(met.degenerate_faces, 1u);
  EXPECT_EQ(met.duplicate_faces, 2u) << "the same three vertices in any order";
  EXPECT_EQ(met.unused_vertices, 2u);
}

TEST(MakeManifold, TurnsTheMinorityOver) {
  Shape shape = testing::sphere(1, 1.0);
  for (std::size_t f = 0; f < 80; f += 9) std::swap(shape.triangles[f][0], shape.triangles[f][1]);
  const auto [mesh, met] = make(as_mesh(shape));
  expect_sound(mesh);
  EXPECT_EQ(met.reoriented_faces, 9u);
  EXPECT_EQ(met.split_vertices, 0u);
  const auto& p = mesh.mesh.positions;
  for (const auto& [a, b, c] : mesh.mesh.triangles) EXPECT_GT((p[b] - p[a]).cross(p[c] - p[a]).dot(p[a]), 0.0);
}

TEST(MakeManifold, GivesTouchingSheetsTheirOwnVertices) {
  // Two triangles that share one vertex only.
  const auto [mesh, met] = make(faces_over_curve(5, {{0, 1, 2}, {2, 3, 4}}));
  expect_sound(mesh);
  EXPECT_EQ(met.split_vertices, 1u);
  EXPECT_EQ(mesh.source, (std::vector<Index>{0, 1, 2, 2, 3, 4}));
  EXPECT_EQ(met.locked_vertices, 0u) << "they can move apart without a gap";
  EXPECT_EQ(num_merged_vertices(mesh), 6u);
}

TEST(MakeManifold, LocksAJunction) {
  // Three faces at edge 0-1: the two that are flattest together pair, the third is left over.
  TriangleMesh fin;
  fin.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0.1}, {0.5, 0.2, 1}};
  fin.triangles = {{0, 1, 2}, {1, 0, 4}, {1, 0, 3}};
  const auto [mesh, met] = make(fin);
  expect_sound(mesh);
  EXPECT_EQ(topology(mesh.mesh).components, 2u);
  EXPECT_EQ(mesh.mesh.triangles[0][0], mesh.mesh.triangles[2][1]) << "faces 0 and 2 stay together";
  EXPECT_EQ(met.locked_vertices, 4u) << "both ends, in both sheets";
  EXPECT_EQ(num_merged_vertices(mesh), 5u);
  ManifoldMesh copy = mesh;
  const SimplifiedMesh merged = merge_copies(std::move(copy));
  EXPECT_EQ(merged.mesh.triangles, fin.triangles);
  EXPECT_EQ(merged.mesh.positions, fin.positions);
}

TEST(MakeManifold, CutsAMoebiusStrip) {
  TriangleMesh strip;
  const Index n = 24;
  for (Index i = 0; i < n; ++i) {
    const double u = 2.0 * std::numbers::pi * i / n;
    const Vec3 out(std::cos(u), std::sin(u), 0);
    for (const double side : {-0.4, 0.4}) {
      strip.positions.push_back(out + side * (std::cos(u / 2) * out + Vec3(0, 0, std::sin(u / 2))));
    }
  }
  for (Index i = 0; i < n; ++i) {
    const Index a = 2 * i, b = a + 1;
    const Index c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;  // the ends meet upside down
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  const auto [mesh, met] = make(strip);
  expect_sound(mesh);
  EXPECT_EQ(met.locked_vertices, 4u) << "both ends of the cut edge, on both sides of it";
  EXPECT_EQ(topology(mesh.mesh).border_loops, 1u);
  EXPECT_EQ(num_merged_vertices(mesh), strip.positions.size()) << "closed again in the end";
}

TEST(MakeManifold, MarksLinesAndLocksTheirEnds) {
  // A 5 x 5 grid with a feature along the middle row, from the border to the last vertex but one.
  const Shape grid = testing::plane(5, 1.0);
  const auto [mesh, met] = make(as_mesh(grid), {{10, 11}, {12, 11}, {12, 13}});
  expect_sound(mesh);
  EXPECT_EQ(std::ranges::minmax(mesh.line[11]).min, 10u);
  EXPECT_EQ(std::ranges::minmax(mesh.line[11]).max, 12u);
  EXPECT_TRUE(mesh.locked[10]) << "three line edges meet";
  EXPECT_TRUE(mesh.locked[13]) << "the line ends";
  EXPECT_EQ(std::ranges::count(mesh.locked, 1), 2);
  EXPECT_EQ(mesh.line[6], (std::array<Index, 2>{kNoIndex, kNoIndex}));
  EXPECT_EQ(met.locked_vertices, 0u) << "lines are no oddity";
}

TEST(MakeManifold, FeaturesThatAreNoEdgesAreIgnored) {
  const auto [mesh, met] = make(as_mesh(testing::plane(5, 1.0)), {{0, 24}, {7, 7}});
  expect_sound(mesh);
  EXPECT_EQ(std::ranges::count(mesh.locked, 1), 0);
}

TEST(MakeManifold, RejectsWhatItCannotUse) {
  EXPECT_THROW(make(faces_over_curve(3, {{0, 1, 3}})), InvalidInput);
  EXPECT_THROW(make(faces_over_curve(3, {{0, 1, 2}}), {{0, 3}}), InvalidInput);
  TriangleMesh mesh = faces_over_curve(4, {{0, 1, 2}});
  mesh.positions[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(make(mesh)) << "nobody uses vertex 3";
  mesh.positions[2].x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(make(mesh), InvalidInput);
}

TEST(MakeManifold, EmptyMesh) {
  EXPECT_EQ(make({}).mesh.mesh.triangles.size(), 0u);
  const auto [mesh, met] = make(faces_over_curve(3, {}));
  EXPECT_EQ(mesh.source.size(), 0u);
  EXPECT_EQ(met.unused_vertices, 3u);
}

// A large fan takes another path than a small one; both kinds, closed and open, and one with two fans.
TEST(MakeManifold, LargeFans) {
  for (const Index n : {5u, 300u}) {
    TriangleMesh wheel = faces_over_curve(n + 1, {});
    for (Index i = 0; i < n; ++i) wheel.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    std::ranges::sort(wheel.triangles, {}, [](const Triangle& t) { return random_bits(3, 0, t[1]); });
    auto made = make(wheel);
    expect_sound(made.mesh);
    EXPECT_EQ(made.met.split_vertices, 0u);
    EXPECT_EQ(made.mesh.line[0][0], kNoIndex) << "closed";
    wheel.triangles.pop_back();
    made = make(wheel);
    expect_sound(made.mesh);
    EXPECT_EQ(made.met.split_vertices, 0u);
    EXPECT_NE(made.mesh.line[0][0], kNoIndex) << "open";
    wheel.triangles.erase(wheel.triangles.begin() + 1);
    made = make(wheel);
    expect_sound(made.mesh);
    EXPECT_LE(made.met.split_vertices, 1u);
  }
}

// Any soup of indices becomes a manifold, and merging gives the faces back.
TEST(MakeManifold, RandomSoups) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto number = [&](std::uint64_t stream, std::uint64_t id, std::size_t below) {
      return static_cast<Index>(random_bits(seed, stream, id) % below);
    };
    const Index n = 3 + number(0, 0, 20);
    const Index num_faces = 1 + number(0, 1, 60);
    TriangleMesh soup;
    for (Index i = 0; i < n; ++i) {
      soup.positions.emplace_back(random01(seed, 1, i), random01(seed, 2, i), random01(seed, 3, i));
    }
    for (Index f = 0; f < num_faces; ++f) soup.triangles.push_back({number(4, f, n), number(5, f, n), number(6, f, n)});
    FeatureEdges features;
    for (Index i = 0; i < number(0, 2, 6); ++i) features.push_back({number(7, i, n), number(8, i, n)});
    const auto [mesh, met] = make(soup, features);
    SCOPED_TRACE(seed);
    expect_sound(mesh);
    EXPECT_EQ(mesh.mesh.triangles.size() + met.degenerate_faces + met.duplicate_faces, num_faces);
    EXPECT_EQ(mesh.source.size(), n - met.unused_vertices + met.split_vertices);
    ManifoldMesh copy = mesh;
    const std::size_t merged = num_merged_vertices(mesh);
    const SimplifiedMesh back = merge_copies(std::move(copy));
    EXPECT_EQ(back.source_vertex.size(), merged);
    ASSERT_EQ(back.mesh.triangles.size(), mesh.mesh.triangles.size());
    for (std::size_t f = 0; f < back.mesh.triangles.size(); ++f) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(back.source_vertex[back.mesh.triangles[f][c]], mesh.source[mesh.mesh.triangles[f][c]]);
      }
    }
  }
}

TEST(MergeCopies, SortsBySourceAndDropsWhatNobodyUses) {
  ManifoldMesh mesh;
  mesh.mesh.positions = {{9, 0, 0}, {5, 0, 0}, {7, 0, 0}, {1, 1, 0}, {5, 0, 0}};
  mesh.source = {9, 5, 7, 1, 5};
  mesh.locked = {0, 1, 0, 0, 1};
  mesh.line.assign(5, {kNoIndex, kNoIndex});
  mesh.mesh.triangles = {{0, 1, 3}, {3, 4, 0}, {1, 4, 0}};
  EXPECT_EQ(num_merged_vertices(mesh), 4u);
  const SimplifiedMesh merged = merge_copies(std::move(mesh));
  EXPECT_EQ(merged.source_vertex, (std::vector<Index>{1, 5, 9}));
  EXPECT_EQ(merged.mesh.triangles, (std::vector<Triangle>{{2, 1, 0}, {0, 1, 2}})) << "the last face has closed up";
}

TEST(MakeManifold, SameForAnyNumberOfThreads) {
  Shape shape = testing::torus(120, 60, 2.0, 0.5);
  shape.triangles.push_back({0, 500, 900});
  shape.triangles.erase(shape.triangles.begin() + 77);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const ManifoldMesh mesh = make_manifold(as_mesh(shape), {{5, 6}, {6, 7}}, context, nullptr);
    return std::tuple(mesh.mesh.triangles, mesh.source, mesh.locked, mesh.line);
  });
}

}  // namespace
}  // namespace shapelight::simplification
