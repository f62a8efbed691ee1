#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "shapelight/pipeline/sample.hpp"
#include "support/data_files.hpp"
#include "support/shapes.hpp"

// What users of point cloud programs ask for: two planes that meet in a rounded edge, with bumps beside it. A sample
// shall keep points across and along the edge and on the bumps, and few, though some, on the flat parts.
namespace shapelight {
namespace {

using namespace shapelight::testing;

constexpr double kStep = 1.0;           // spacing of the points, h
constexpr double kRadius = 3.0 * kStep;
constexpr int kAlong = 120;             // points along the edge
constexpr double kFlat = 50.0;          // width of each plane beyond the rounding
constexpr double kBumpHeight = 3.0;
constexpr double kBumpSigma = 3.0;
constexpr double kArc = kRadius * std::numbers::pi / 2.0;
struct Bump {
  double across, along;  // across: arc length from the middle of the rounding
};
constexpr Bump kBumps[] = {{-30.0, 30.0}, {-28.0, 85.0}, {25.0, 60.0}, {32.0, 20.0}, {30.0, 100.0}};

struct Profile {
  Vec3 position, normal;
};

// The surface without bumps, by arc length across the edge and length along it.
Profile profile(double across, double along) {
  const double half = 0.5 * kArc;
  const double angle = std::clamp(across / kRadius, -std::numbers::pi / 4.0, std::numbers::pi / 4.0);
  const Vec3 normal(std::sin(angle), 0.0, std::cos(angle));
  const Vec3 tangent(std::cos(angle), 0.0, -std::sin(angle));
  const double beyond = across - std::clamp(across, -half, half);
  return {kRadius * normal + beyond * tangent + Vec3(0, along, 0), normal};
}

struct Model {
  Geometry geometry;
  std::vector<double> across, along;
  std::vector<std::uint8_t> on_bump;
};

Model rounded_edge(double jitter) {
  Model model;
  const int columns = static_cast<int>(std::lround((2.0 * kFlat + kArc) / kStep)) + 1;
  for (int r = 0; r < kAlong; ++r) {
    for (int c = 0; c < columns; ++c) {
      const auto id = static_cast<std::uint64_t>(r * columns + c);
      const double u = kStep * (c - 0.5 * (columns - 1)) + jitter * kStep * (2.0 * random01(1, 0, id) - 1.0);
      const double v = kStep * r + jitter * kStep * (2.0 * random01(1, 1, id) - 1.0);
      const Profile base = profile(u, v);
      double height = 0.0;
      bool on_bump = false;
      for (const Bump& bump : kBumps) {
        const double d = std::hypot(u - bump.across, v - bump.along);
        height += kBumpHeight * std::exp(-0.5 * d * d / (kBumpSigma * kBumpSigma));
        on_bump |= d < 2.5 * kBumpSigma;
      }
      model.geometry.positions.push_back(base.position + height * base.normal);
      model.across.push_back(u);
      model.along.push_back(v);
      model.on_bump.push_back(on_bump);
    }
  }
  Shape faces;
  add_grid_faces(faces, static_cast<Index>(columns), kAlong, false, false);
  model.geometry.triangles = faces.triangles;
  return model;
}

void expect_good_sample(const Model& model, const Geometry& geometry, const char* name) {
  const auto indices = sample(geometry, {.count = {}, .ratio = 0.05, .spacing = {}}).indices;
  const double uniform = 0.05;
  std::size_t on_edge = 0, edge_points = 0, on_flat = 0, flat_points = 0;
  const auto is_edge = [&](std::size_t i) { return std::abs(model.across[i]) <= 0.5 * kArc + kStep; };
  const auto is_flat = [&](std::size_t i) {
    const double from_rim = std::min({kFlat + 0.5 * kArc - std::abs(model.across[i]), model.along[i], kAlong - 1 - model.along[i]});
    return std::abs(model.across[i]) > 0.5 * kArc + 4.0 * kStep && !model.on_bump[i] && from_rim > 3.0 * kStep;
  };
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    edge_points += is_edge(i);
    flat_points += is_flat(i);
  }
  std::vector<double> along_edge = {0.0, kStep * (kAlong - 1)};
  std::size_t left = 0, right = 0;
  for (const Index i : indices) {
    if (is_flat(i)) ++on_flat;
    if (!is_edge(i)) continue;
    ++on_edge;
    along_edge.push_back(model.along[i]);
    (model.across[i] < 0.0 ? left : right) += 1;
  }
  std::sort(along_edge.begin(), along_edge.end());
  double gap = 0.0;
  for (std::size_t i = 1; i < along_edge.size(); ++i) gap = std::max(gap, along_edge[i] - along_edge[i - 1]);
  const double edge_density = static_cast<double>(on_edge) / static_cast<double>(edge_points) / uniform;
  const double flat_density = static_cast<double>(on_flat) / static_cast<double>(flat_points) / uniform;

  double widest = 0.0;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    double nearest = HUGE_VAL;
    for (const Index k : indices) nearest = std::min(nearest, (geometry.positions[i] - geometry.positions[k]).norm());
    widest = std::max(widest, nearest);
  }
  const double spacing = kStep / std::sqrt(uniform);  // of a uniform sample
  std::printf("%s: edge %.2f x uniform (gap along %.2f h), flat %.2f x uniform, largest hole %.2f uniform spacings\n", name,
              edge_density, gap, flat_density, widest / spacing);
  EXPECT_GE(edge_density, 2.5) << name;
  EXPECT_LE(gap, spacing) << name << ": a gap along the edge";
  EXPECT_GE(std::min(left, right), on_edge / 4) << name << ": one side of the edge only";
  EXPECT_LT(flat_density, 1.0) << name;
  EXPECT_GT(flat_density, 0.15) << name;
  EXPECT_LE(widest, 2.0 * spacing) << name << ": a hole";
  for (const Bump& bump : kBumps) {
    const auto near = std::count_if(indices.begin(), indices.end(), [&](Index i) {
      return std::hypot(model.across[i] - bump.across, model.along[i] - bump.along) < 2.5 * kBumpSigma;
    });
    const double expected = uniform * std::numbers::pi * std::pow(2.5 * kBumpSigma, 2) / (kStep * kStep);
    std::printf("  bump at (%g, %g): %.2f x uniform\n", bump.across, bump.along, static_cast<double>(near) / expected);
    EXPECT_GE(static_cast<double>(near), expected) << name << ": bump at " << bump.across << ", " << bump.along;
  }
}

TEST(RoundedEdge, OfAMesh) {
  const Model model = rounded_edge(0.2);
  expect_good_sample(model, model.geometry, "mesh");
}

TEST(RoundedEdge, OfARawCloud) {
  const Model model = rounded_edge(0.2);
  expect_good_sample(model, as_cloud(model.geometry), "cloud");
}

}  // namespace
}  // namespace shapelight
