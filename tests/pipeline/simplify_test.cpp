#include "shapelight/pipeline/simplify.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "shapelight/core/error.hpp"
#include "shapelight/graph/build_graph.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

// The pipeline around the algorithms: counts, kinds of input, order, place, cancellation, measured error.
namespace shapelight {
namespace {

using namespace shapelight::testing;

Geometry geometry_of(const Shape& shape) {
  Geometry geometry;
  geometry.positions = shape.positions;
  geometry.triangles = shape.triangles;
  return geometry;
}

SimplifySize vertices(std::uint64_t count) { return {.vertices = count, .faces = {}, .ratio = {}, .max_error = {}}; }
SimplifySize faces(std::uint64_t count) { return {.vertices = {}, .faces = count, .ratio = {}, .max_error = {}}; }
SimplifySize share(double ratio) { return {.vertices = {}, .faces = {}, .ratio = ratio, .max_error = {}}; }
SimplifySize within(double error) { return {.vertices = {}, .faces = {}, .ratio = {}, .max_error = error}; }

SimplifyOptions options_for(SimplifyMethod method, Placement placement = Placement::Input) {
  SimplifyOptions options = simplify_preset(SimplifyPreset::Fast, placement);
  options.method = method;
  return options;
}

// Every method with every placement that it has.
std::vector<std::pair<std::string, SimplifyOptions>> all_methods() {
  std::vector<std::pair<std::string, SimplifyOptions>> all;
  for (const auto& [method, method_name] : enum_names(SimplifyMethod{})) {
    for (const auto& [placement, placement_name] : enum_names(Placement{})) {
      if (method == SimplifyMethod::SsimPaper && placement == Placement::Optimal) continue;
      all.emplace_back(std::string(method_name) + " " + std::string(placement_name), options_for(method, placement));
    }
  }
  return all;
}

// Two spheres and, at (9, 0, 0), an open patch; two of the vertices are in no face, one of them nowhere.
Geometry several_parts() {
  Geometry all = geometry_of(sphere(3, 1.0, 0.2));
  const auto add = [&](const Shape& shape, const Vec3& shift) {
    const auto base = static_cast<Index>(all.size());
    for (const Vec3& p : shape.positions) all.positions.push_back(p + shift);
    for (const Triangle& t : shape.triangles) all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  };
  add(sphere(2, 0.5, 0.2), {4, 0, 0});
  add(saddle(12, 0.1, 0.2), {9, 0, 0});
  all.positions.emplace_back(0, 7, 0);
  all.positions.push_back(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  return all;
}

// Three half discs that meet in one line: its edges have three faces each.
Geometry three_wings() {
  Geometry wings;
  constexpr Index kSide = 9;
  for (int wing = 0; wing < 3; ++wing) {
    const double angle = 2.0 * wing;
    const Shape flat = plane(kSide, 1.0, 0.1);
    const auto base = static_cast<Index>(wings.size());
    const auto id = [&](Index v) { return wing > 0 && v < kSide ? v : static_cast<Index>(base + v - (wing > 0 ? kSide : 0)); };
    for (Index v = wing > 0 ? kSide : 0; v < flat.positions.size(); ++v) {
      const Vec3& p = flat.positions[v];
      const double y = p.y() - flat.positions[0].y();
      wings.positions.push_back(v < kSide ? Vec3(p.x(), 0, 0) : Vec3(p.x(), y * std::cos(angle), y * std::sin(angle)));
    }
    for (const Triangle& t : flat.triangles) wings.triangles.push_back({id(t[0]), id(t[1]), id(t[2])});
  }
  return wings;
}

TEST(Simplify, CountsAreExactOnEveryKindOfSurface) {
  const std::vector<std::pair<std::string, Geometry>> inputs = {
      {"closed", geometry_of(torus(24, 16, 3.0, 1.0))},
      {"open", geometry_of(saddle(18, 0.1, 0.2))},
      {"several parts", several_parts()},
      {"non-manifold", three_wings()},
      {"range image", read_data("scans/bun000_quarter.rif")}};
  for (const auto& [input_name, input] : inputs) {
    for (const auto& [name, options] : all_methods()) {
      SCOPED_TRACE(input_name + ", " + name);
      const SimplifyResult all = simplify(input, share(1.0), options);
      EXPECT_EQ(all.geometry.size(), std::min(all.vertices_in, all.surface_vertices));
      for (const double ratio : {0.87, 0.5, 0.21}) {
        const std::size_t count = static_cast<std::size_t>(ratio * static_cast<double>(all.surface_vertices));
        const SimplifyResult done = simplify(input, vertices(count), options);
        EXPECT_EQ(done.geometry.size(), count);
        EXPECT_EQ(done.source_vertex.size(), count);
        EXPECT_EQ(done.geometry.kind(), GeometryKind::Mesh);
      }
      for (const double ratio : {0.6, 0.3}) {
        const std::size_t count = static_cast<std::size_t>(ratio * static_cast<double>(all.faces_in));
        const SimplifyResult done = simplify(input, faces(count), options);
        EXPECT_NEAR(static_cast<double>(done.geometry.triangles.size()), static_cast<double>(count), 1.0);
      }
    }
  }
}

TEST(Simplify, RatiosAreOfTheFiniteVertices) {
  const Geometry input = several_parts();
  const std::size_t finite = input.size() - 1;
  const SimplifyResult done = simplify(input, share(0.3));
  EXPECT_EQ(done.vertices_in, finite);
  EXPECT_EQ(done.surface_vertices, finite - 1);
  EXPECT_EQ(done.geometry.size(), static_cast<std::size_t>(std::llround(0.3 * static_cast<double>(finite))));
  EXPECT_EQ(done.oddities.unused_vertices, 2u);
  const SimplifyResult whole = simplify(input, share(1.0));
  EXPECT_EQ(whole.geometry.size(), finite - 1) << "all that there are";
  EXPECT_TRUE(std::any_of(whole.warnings.begin(), whole.warnings.end(),
                          [](const std::string& w) { return w.find("all are kept") != std::string::npos; }));
}

TEST(Simplify, InputPlacementKeepsInputVerticesBitForBit) {
  Geometry input = geometry_of(sphere(4, 1.0, 0.2));
  for (Vec3& p : input.positions) p += Vec3(512000.125, 4.8e6, 33.3);  // far from the origin
  for (const auto& [name, options] : all_methods()) {
    if (options.ssim.placement != Placement::Input) continue;
    const SimplifyResult done = simplify(input, share(0.1), options);
    std::set<Index> sources(done.source_vertex.begin(), done.source_vertex.end());
    EXPECT_EQ(sources.size(), done.source_vertex.size()) << name;
    for (std::size_t v = 0; v < done.geometry.size(); ++v) {
      ASSERT_EQ(done.geometry.positions[v], input.positions[done.source_vertex[v]]) << name;
    }
  }
  const SimplifyResult free = simplify(input, share(0.1), options_for(SimplifyMethod::Ssim, Placement::Optimal));
  for (const Vec3& p : free.geometry.positions) {
    EXPECT_NEAR((p - Vec3(512000.125, 4.8e6, 33.3)).norm(), 1.0, 0.02);
  }
}

TEST(Simplify, WhatCannotBeReachedIsSaid) {
  const Geometry ball = geometry_of(sphere(2, 1.0));
  for (const auto& [name, options] : all_methods()) {
    SCOPED_TRACE(name);
    const auto reachable = [&, &o = options](const SimplifySize& size) -> std::uint64_t {
      try {
        (void)simplify(ball, size, o);
      } catch (const TargetUnreachable& error) {
        return error.reachable();
      }
      return 0;
    };
    EXPECT_EQ(reachable(vertices(163)), 162u);
    EXPECT_EQ(reachable(faces(322)), 320u);
    const std::uint64_t least = reachable(vertices(3));
    EXPECT_GE(least, 4u);
    EXPECT_EQ(simplify(ball, vertices(least), options).geometry.size(), least);
  }
}

TEST(Simplify, BadInputIsRefused) {
  const Geometry ball = geometry_of(sphere(1, 1.0));
  EXPECT_THROW((void)simplify(ball, {}), InvalidInput);
  EXPECT_THROW((void)simplify(ball, {.vertices = 5, .faces = 5, .ratio = {}, .max_error = {}}), InvalidInput);
  EXPECT_THROW((void)simplify(ball, vertices(0)), InvalidInput);
  EXPECT_THROW((void)simplify(ball, faces(0)), InvalidInput);
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW((void)simplify(ball, share(bad)), InvalidInput);
    EXPECT_THROW((void)simplify(ball, within(bad)), InvalidInput);
  }
  EXPECT_THROW((void)simplify(ball, share(1.1)), InvalidInput);
  SimplifyOptions options;
  options.ssim.pre_collapse = 0.5;
  EXPECT_THROW((void)simplify(ball, share(0.5), options), InvalidInput);
  EXPECT_THROW((void)simplify_preset(SimplifyPreset::Paper, Placement::Optimal), InvalidInput);
  EXPECT_THROW((void)simplify(ball, share(0.5), options_for(SimplifyMethod::SsimPaper, Placement::Optimal)), InvalidInput);
  Geometry outside = ball;
  outside.triangles[3][1] = 42;
  EXPECT_THROW((void)simplify(outside, share(0.5)), InvalidInput);
  Geometry nowhere = ball;
  for (Vec3& p : nowhere.positions) p.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW((void)simplify(nowhere, share(0.5)), InvalidInput);
  Geometry degenerate = ball;
  for (Triangle& t : degenerate.triangles) t[1] = t[0];
  EXPECT_THROW((void)simplify(degenerate, share(0.5)), InvalidInput);
}

TEST(Simplify, FacesAtPlacesThatAreNotFiniteAreLeftOut) {
  Geometry input = geometry_of(plane(12, 1.0, 0.2));
  input.positions[50].x() = std::numeric_limits<double>::infinity();
  const SimplifyResult done = simplify(input, share(0.5));
  EXPECT_EQ(done.surface_vertices, 143u);
  EXPECT_EQ(done.geometry.size(), 72u);
  EXPECT_TRUE(std::find(done.source_vertex.begin(), done.source_vertex.end(), Index{50}) == done.source_vertex.end());
}

TEST(Simplify, CloudsGiveClouds) {
  const Geometry cloud = as_cloud(geometry_of(sphere(3, 1.0, 0.2)));
  for (const SimplifyPreset preset : {SimplifyPreset::Detail, SimplifyPreset::Fast, SimplifyPreset::Paper}) {
    const SimplifyResult done = simplify(cloud, share(0.25), simplify_preset(preset));
    EXPECT_TRUE(done.sampled);
    EXPECT_EQ(done.geometry.kind(), GeometryKind::Cloud);
    EXPECT_EQ(done.geometry.size(), 161u);  // of 642
    EXPECT_FALSE(done.warnings.empty());
    for (std::size_t i = 0; i < done.geometry.size(); ++i) {
      ASSERT_EQ(done.geometry.positions[i], cloud.positions[done.source_vertex[i]]);
    }
  }
  EXPECT_EQ(simplify(cloud, vertices(7)).geometry.size(), 7u);
  EXPECT_THROW((void)simplify(cloud, faces(10)), InvalidInput);
  EXPECT_THROW((void)simplify(cloud, within(0.1)), InvalidInput);
  EXPECT_THROW((void)simplify(cloud, share(0.5), simplify_preset(SimplifyPreset::Best, Placement::Optimal)), InvalidInput);
  EXPECT_THROW((void)simplify(cloud, share(0.5), options_for(SimplifyMethod::Qslim)), InvalidInput);
}

TEST(Simplify, RangeImagesLookAtTheirViewer) {
  Geometry image = read_data("scans/bun000_quarter.rif");
  const auto towards = [&](const Geometry& mesh, const Vec3& eye) {
    double sum = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3& p = mesh.positions[a];
      sum += (mesh.positions[b] - p).cross(mesh.positions[c] - p).dot(eye - p);
    }
    return sum;
  };
  const BoundingBox box = bounding_box(image.positions);
  for (const double side : {-1.0, 1.0}) {  // whichever side the sensor was on
    image.viewpoint = box.center() + Vec3(0, 0, side * 100.0 * box.diagonal());
    const SimplifyResult done = simplify(image, share(0.3));
    EXPECT_GT(towards(done.geometry, *image.viewpoint), 0.0);
    EXPECT_FALSE(done.geometry.grid.has_value());
    EXPECT_EQ(done.geometry.kind(), GeometryKind::Mesh);
  }
}

TEST(Simplify, NoiseIsMeasuredAndSaid) {
  const Geometry clean = geometry_of(sphere(4, 1.0, 0.2));
  const double edge = build_graph(clean).graph.mean_edge_length;
  const SimplifyResult quiet = simplify(clean, share(0.2));
  EXPECT_FALSE(quiet.denoised);
  const Geometry noisy = geometry_of(with_noise(sphere(4, 1.0, 0.2), 0.2 * edge));
  for (const Placement placement : {Placement::Input, Placement::Optimal}) {
    const SimplifyResult loud = simplify(noisy, share(0.2), simplify_preset(SimplifyPreset::Detail, placement));
    EXPECT_TRUE(loud.denoised);
    EXPECT_NEAR(loud.noise, 0.2 * edge, 0.03 * edge);
    double off = 0.0;
    for (const Vec3& p : loud.geometry.positions) off += std::abs(p.norm() - 1.0) / static_cast<double>(loud.geometry.size());
    if (placement == Placement::Optimal) {
      EXPECT_LT(off, 0.11 * edge) << "the vertices lie on the denoised surface";
    }
  }
  SimplifyOptions never;
  never.noise_threshold = 1e6;
  EXPECT_FALSE(simplify(noisy, share(0.2), never).denoised);
}

TEST(Simplify, MaxErrorGivesTheCoarsestWithin) {
  const Geometry input = geometry_of(torus(30, 20, 3.0, 1.0));
  for (const Placement placement : {Placement::Input, Placement::Optimal}) {
    const SimplifyOptions options = simplify_preset(SimplifyPreset::Fast, placement);
    for (const double bound : {0.5, 0.1}) {
      SCOPED_TRACE(fmt::format("{} {}", enum_name(placement), bound));
      const SimplifyResult done = simplify(input, within(bound), options);
      ASSERT_TRUE(done.measured.has_value());
      EXPECT_LE(done.measured->symmetric.max, bound);
      EXPECT_LE(done.runs, 9u);
      SimplifyOptions measuring = options;
      measuring.measure = true;
      const SimplifyResult again = simplify(input, vertices(done.geometry.size()), measuring);
      EXPECT_EQ(again.geometry.triangles, done.geometry.triangles);
      EXPECT_EQ(again.measured->symmetric.max, done.measured->symmetric.max);
      const SimplifyResult coarser =
          simplify(input, vertices(static_cast<std::uint64_t>(0.7 * static_cast<double>(done.geometry.size()))), measuring);
      EXPECT_GT(coarser.measured->symmetric.max, bound) << "far fewer vertices do not do";
    }
  }
}

TEST(Simplify, AnyErrorIsAllowedDownToTheLeastMesh) {
  const SimplifyResult done = simplify(geometry_of(sphere(2, 1.0)), within(1000.0));
  EXPECT_LE(done.geometry.size(), 5u);
}

TEST(Simplify, SameForAnyNumberOfThreads) {
  for (const char* file : {"meshes/fandisk.off", "scans/bun000_quarter.rif"}) {
    const Geometry input = read_data(file);
    for (const auto& [name, options] : all_methods()) {
      SCOPED_TRACE(name);
      expect_same_for_any_number_of_threads([&, &o = options](const RunContext& context) {
        const SimplifyResult done = simplify(input, share(0.3), o, context);
        return std::pair(done.geometry.positions, done.geometry.triangles);
      });
    }
  }
}

TEST(Simplify, ProgressRisesToOneAndAStopEndsItAnywhere) {
  const Geometry input = geometry_of(sphere(3, 1.0, 0.2));
  for (const auto& [size, step] : {std::pair(share(0.2), std::size_t{5}), std::pair(within(0.05), std::size_t{61})}) {
    std::vector<double> fractions;
    RunContext watching;
    watching.progress = [&](double fraction, std::string_view) { fractions.push_back(fraction); };
    (void)simplify(input, size, {}, watching);
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_EQ(fractions.back(), 1.0);
    EXPECT_LE(fractions.size(), 400u);
    for (std::size_t at = 0; at + 1 < fractions.size(); at += step) {
      std::stop_source stop;
      RunContext context;
      context.stop = stop.get_token();
      std::size_t call = 0;
      context.progress = [&](double, std::string_view) {
        if (call++ == at) stop.request_stop();
      };
      EXPECT_THROW((void)simplify(input, size, {}, context), Cancelled) << "call " << at;
    }
  }
}

}  // namespace
}  // namespace shapelight
