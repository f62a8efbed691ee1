#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "shapelight/pipeline/simplify.hpp"
#include "support/data_files.hpp"
#include "support/shapes.hpp"

// What vertices, triangles and corners carry follows the simplified mesh.
namespace shapelight {
namespace {

using namespace shapelight::testing;

SimplifySize share(double ratio) { return {.vertices = {}, .faces = {}, .ratio = ratio, .max_error = {}}; }

Geometry geometry_of(const Shape& shape) {
  Geometry geometry;
  geometry.positions = shape.positions;
  geometry.triangles = shape.triangles;
  return geometry;
}

// A bumpy patch with one column of every kind, each a known function of the place.
Geometry carrying_patch() {
  const Shape shape = saddle(24, 0.1, 0.2);
  Geometry patch = geometry_of(shape);
  const std::size_t n = patch.size();
  std::vector<float> heat(n), nx(n), ny(n), nz(n);
  std::vector<double> time(n);
  std::vector<std::uint8_t> red(n), label(n);
  std::vector<std::int16_t> level(n);
  std::vector<std::uint64_t> key(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = patch.positions[i];
    heat[i] = static_cast<float>(3.0 * p.x() - p.y());
    time[i] = 3e8 + p.x();
    red[i] = static_cast<std::uint8_t>(std::lround(128.0 + 80.0 * p.x()));
    level[i] = static_cast<std::int16_t>(std::lround(-1000.0 * p.y()));
    label[i] = p.x() < 0.0 ? 3 : 200;
    key[i] = (std::uint64_t{1} << 60) + i;
    nx[i] = static_cast<float>(shape.normals[i].x());
    ny[i] = static_cast<float>(shape.normals[i].y());
    nz[i] = static_cast<float>(shape.normals[i].z());
  }
  for (Column column : {Column{"heat", heat}, Column{"time", time}, Column{"red", red}, Column{"level", level},
                        Column{"label", label}, Column{"key", key}, Column{"nx", nx}, Column{"ny", ny}, Column{"nz", nz}}) {
    patch.attributes.set(std::move(column));
  }
  std::vector<std::int32_t> part;
  for (const auto& [a, b, c] : patch.triangles) {
    part.push_back((patch.positions[a] + patch.positions[b] + patch.positions[c]).y() < 0.0 ? 7 : -7);
  }
  patch.triangle_attributes.set({"part", part});
  return patch;
}

TEST(SimplifyAttributes, InputPlacementTakesTheSourcesOwn) {
  const Geometry input = carrying_patch();
  const SimplifyResult done = simplify(input, share(0.3));
  ASSERT_EQ(done.geometry.attributes.columns().size(), input.attributes.columns().size());
  for (const Column& column : input.attributes.columns()) {
    const Column* same = done.geometry.attributes.find(column.name);
    ASSERT_NE(same, nullptr) << column.name;
    EXPECT_EQ(same->values, column.gather(done.source_vertex).values) << column.name;
  }
}

TEST(SimplifyAttributes, OptimalPlacementInterpolatesByType) {
  const Geometry input = carrying_patch();
  const SimplifyResult done = simplify(input, share(0.3), simplify_preset(SimplifyPreset::Detail, Placement::Optimal));
  const AttributeTable& table = done.geometry.attributes;
  ASSERT_EQ(table.columns().size(), input.attributes.columns().size());
  for (const Column& column : input.attributes.columns()) {
    EXPECT_EQ(table.find(column.name)->type(), column.type()) << column.name;
  }
  std::size_t moved = 0;
  for (std::size_t v = 0; v < done.geometry.size(); ++v) {
    const Vec3& p = done.geometry.positions[v];
    moved += p != input.positions[done.source_vertex[v]];
    // Functions of the place: right but for the distance between vertex and surface, and rounding.
    EXPECT_NEAR(table.find("heat")->as_double(v), 3.0 * p.x() - p.y(), 0.1);
    EXPECT_NEAR(table.find("time")->as_double(v), 3e8 + p.x(), 0.03);
    EXPECT_NEAR(table.find("red")->as_double(v), 128.0 + 80.0 * p.x(), 3.0);
    EXPECT_NEAR(table.find("level")->as_double(v), -1000.0 * p.y(), 30.0);
    const double label = table.find("label")->as_double(v);
    EXPECT_TRUE(label == 3.0 || label == 200.0) << label << ": labels are never mixed";
    if (std::abs(p.x()) > 0.15) {
      EXPECT_EQ(label, p.x() < 0.0 ? 3.0 : 200.0);
    }
    const auto& keys = std::get<std::vector<std::uint64_t>>(table.find("key")->values);
    EXPECT_LT(keys[v] - (std::uint64_t{1} << 60), input.size()) << "no bit of a 64-bit number is lost";
    const Vec3 normal(table.find("nx")->as_double(v), table.find("ny")->as_double(v), table.find("nz")->as_double(v));
    EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
    EXPECT_GT(normal.dot(Vec3(-p.x(), p.y(), 1.0).normalized()), 0.99);
  }
  EXPECT_GT(moved, done.geometry.size() / 2);
}

TEST(SimplifyAttributes, TrianglesTakeThoseBelowThem) {
  const Geometry input = carrying_patch();
  for (const Placement placement : {Placement::Input, Placement::Optimal}) {
    const SimplifyResult done = simplify(input, share(0.3), simplify_preset(SimplifyPreset::Detail, placement));
    const Column* part = done.geometry.triangle_attributes.find("part");
    ASSERT_NE(part, nullptr);
    ASSERT_EQ(part->size(), done.geometry.triangles.size());
    for (std::size_t t = 0; t < part->size(); ++t) {
      double y = 0.0;
      for (const Index v : done.geometry.triangles[t]) y += done.geometry.positions[v].y() / 3.0;
      if (std::abs(y) > 0.1) {
        EXPECT_EQ(part->as_double(t), y < 0.0 ? 7.0 : -7.0);
      }
    }
  }
}

using TexCoord = std::array<float, 2>;

// A closed cylinder-like tube unrolled to [0, 1]^2 with a seam along it, or a patch of two charts side by side.
Geometry textured_tube() {
  Geometry tube = geometry_of(cylinder(24, 16, 1.0));
  const double height = tube.positions.back().z();
  for (const Triangle& t : tube.triangles) {
    std::array<double, 3> u{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = tube.positions[t[k]];
      u[k] = std::atan2(p.y(), p.x()) / (2.0 * std::numbers::pi);
      if (u[k] < -1e-9) u[k] += 1.0;
    }
    for (double& w : u) {  // across the seam: the side of the triangle's other corners
      if (*std::max_element(u.begin(), u.end()) - w > 0.5) w += 1.0;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      tube.corner_texcoords.push_back({static_cast<float>(u[k]), static_cast<float>(tube.positions[t[k]].z() / height)});
    }
  }
  return tube;
}

Geometry two_charts() {
  Geometry patch = geometry_of(plane(20, 0.1));
  for (Vec3& p : patch.positions) p.z() = 0.1 * std::sin(3.0 * p.x()) * std::cos(2.0 * p.y());
  for (const Triangle& t : patch.triangles) {
    double x = 0.0;
    for (const Index v : t) x += patch.positions[v].x() / 3.0;
    for (const Index v : t) {
      const Vec3& p = patch.positions[v];
      patch.corner_texcoords.push_back({static_cast<float>(p.x() + (x < 0.0 ? 10.0 : 20.0)), static_cast<float>(p.y())});
    }
  }
  return patch;
}

// Every (u, v) that the faces around a vertex have there.
std::map<Index, std::vector<TexCoord>> texcoords_by_vertex(const Geometry& mesh) {
  std::map<Index, std::vector<TexCoord>> all;
  for (std::size_t c = 0; c < mesh.corner_texcoords.size(); ++c) {
    all[mesh.triangles[c / 3][c % 3]].push_back(mesh.corner_texcoords[c]);
  }
  return all;
}

TEST(SimplifyTexture, CornersOfKeptVerticesHaveOneOfTheirOwnCoordinates) {
  for (const Geometry& input : {textured_tube(), two_charts()}) {
    for (const SimplifyMethod method : {SimplifyMethod::Ssim, SimplifyMethod::SsimPaper, SimplifyMethod::Qslim}) {
      SimplifyOptions options;
      options.method = method;
      const SimplifyResult done = simplify(input, share(0.3), options);
      ASSERT_EQ(done.geometry.corner_texcoords.size(), 3 * done.geometry.triangles.size());
      const auto before = texcoords_by_vertex(input);
      for (std::size_t c = 0; c < done.geometry.corner_texcoords.size(); ++c) {
        const Index source = done.source_vertex[done.geometry.triangles[c / 3][c % 3]];
        const auto& own = before.at(source);
        EXPECT_TRUE(std::find(own.begin(), own.end(), done.geometry.corner_texcoords[c]) != own.end()) << "corner " << c;
      }
    }
  }
}

TEST(SimplifyTexture, NoFaceCrossesASeam) {
  for (const Placement placement : {Placement::Input, Placement::Optimal}) {
    for (const SimplifyMethod method : {SimplifyMethod::Ssim, SimplifyMethod::Qslim}) {
      SCOPED_TRACE(std::string(enum_name(placement)) + " " + std::string(enum_name(method)));
      SimplifyOptions options = simplify_preset(SimplifyPreset::Detail, placement);
      options.method = method;
      const Geometry charts = simplify(two_charts(), share(0.3), options).geometry;
      for (std::size_t t = 0; t < charts.triangles.size(); ++t) {
        const TexCoord* uv = &charts.corner_texcoords[3 * t];
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_EQ(uv[k][0] < 15.0F, uv[0][0] < 15.0F) << "face " << t << " lies in two charts";
          const double chart = uv[k][0] < 15.0F ? 10.0 : 20.0;
          const Vec3& p = charts.positions[charts.triangles[t][k]];
          EXPECT_NEAR(uv[k][0] - chart, p.x(), 0.05);
          EXPECT_NEAR(uv[k][1], p.y(), 0.05);
        }
      }
      const Geometry tube = simplify(textured_tube(), share(0.3), options).geometry;
      for (std::size_t t = 0; t < tube.triangles.size(); ++t) {
        const TexCoord* uv = &tube.corner_texcoords[3 * t];
        const auto [low, high] = std::minmax({uv[0][0], uv[1][0], uv[2][0]});
        EXPECT_LT(high - low, 0.5F) << "face " << t << " runs around the whole tube in the picture";
      }
    }
  }
}

TEST(SimplifyTexture, WithoutSeamsNothingIsHeld) {
  // The same coordinates in all corners of a vertex: no seam, so as free as without texture.
  Geometry plain = geometry_of(saddle(24, 0.1, 0.2));
  Geometry textured = plain;
  for (const Triangle& t : plain.triangles) {
    for (const Index v : t) {
      textured.corner_texcoords.push_back({static_cast<float>(plain.positions[v].x()), static_cast<float>(plain.positions[v].y())});
    }
  }
  EXPECT_EQ(simplify(textured, share(0.2)).geometry.triangles, simplify(plain, share(0.2)).geometry.triangles);
}

TEST(SimplifyAttributes, RangeImagesKeepTheirColours) {
  Geometry image = read_data("scans/bun000_quarter.rif");
  std::vector<std::uint16_t> number(image.size());
  for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<std::uint16_t>(i);
  image.attributes.set({"red", number});
  const SimplifyResult done = simplify(image, share(0.2));
  for (std::size_t v = 0; v < done.geometry.size(); ++v) {
    ASSERT_EQ(done.geometry.attributes.find("red")->as_double(v), done.source_vertex[v]);
  }
}

}  // namespace
}  // namespace shapelight
