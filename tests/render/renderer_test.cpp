#include "shapelight/render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stop_token>

#include "shapelight/core/error.hpp"
#include "support/shapes.hpp"

namespace shapelight {
namespace {

constexpr Pixel kWhite = {255, 255, 255};

RenderOptions small() {
  RenderOptions options;
  options.width = 160;
  options.height = 120;
  return options;
}

Geometry mesh_of(const testing::Shape& shape) {
  Geometry geometry;
  geometry.positions = shape.positions;
  geometry.triangles = shape.triangles;
  geometry.format = "ply";
  return geometry;
}

Geometry cloud_of(const testing::Shape& shape) {
  Geometry geometry = mesh_of(shape);
  geometry.triangles.clear();
  return geometry;
}

std::size_t drawn(const Image& image) {
  return static_cast<std::size_t>(
      std::count_if(image.pixels.begin(), image.pixels.end(), [](const Pixel& p) { return p != kWhite; }));
}

double brightness(const Image& image, int x, int y) {
  const Pixel& p = image.at(x, y);
  return p[0] + p[1] + p[2];
}

TEST(ParseView, KnowsTheNamedSidesOfAnObjectWithYUp) {
  const Geometry geometry = mesh_of(testing::sphere(1, 1.0));
  const auto direction = [&](const char* name) { return parse_view(name, geometry).direction; };
  EXPECT_TRUE(direction("front").isApprox(-Vec3::UnitZ()));
  EXPECT_TRUE(direction("back").isApprox(Vec3::UnitZ()));
  EXPECT_TRUE(direction("right").isApprox(-Vec3::UnitX()));
  EXPECT_TRUE(direction("left").isApprox(Vec3::UnitX()));
  EXPECT_TRUE(direction("top").isApprox(-Vec3::UnitY()));
  EXPECT_TRUE(direction("bottom").isApprox(Vec3::UnitY()));
  EXPECT_TRUE(direction("iso").isApprox(-Vec3(1, 1, 1).normalized()));
  EXPECT_TRUE(direction("0,-2.5,1e0").isApprox(-Vec3(0, -2.5, 1).normalized()));
  EXPECT_TRUE(parse_view("top", geometry).up.isApprox(-Vec3::UnitZ()));
  for (const char* name : {"auto", "top", "bottom", "iso", "3,2,1"}) {
    const View view = parse_view(name, geometry);
    EXPECT_NEAR(view.direction.norm(), 1.0, 1e-12);
    EXPECT_NEAR(view.up.norm(), 1.0, 1e-12);
    EXPECT_NEAR(view.up.dot(view.direction), 0.0, 1e-12) << name;
  }
}

TEST(ParseView, RefusesWhatItDoesNotUnderstand) {
  const Geometry geometry = mesh_of(testing::sphere(1, 1.0));
  for (const char* text : {"", "above", "1,2", "1,2,3,4", "1,2,x", "0,0,0", "nan,0,1", "1,,2", ",,"}) {
    EXPECT_THROW(static_cast<void>(parse_view(text, geometry)), InvalidInput) << text;
  }
}

TEST(ParseView, ChoosesUpFromTheData) {
  Geometry geometry = cloud_of(testing::plane(9, 1.0));
  EXPECT_GT(parse_view("auto", geometry).up.z(), 0.5) << "terrain: z is up";
  EXPECT_LT(parse_view("auto", geometry).direction.z(), -0.5) << "and it is seen from above";
  geometry = mesh_of(testing::sphere(2, 1.0));
  EXPECT_GT(parse_view("auto", geometry).up.y(), 0.9);
  geometry.format = "las";
  EXPECT_GT(parse_view("auto", geometry).up.z(), 0.9);
  geometry.format = "ply";
  for (Vec3& p : geometry.positions) p.z() *= 2.0;
  EXPECT_GT(parse_view("auto", geometry).up.z(), 0.9) << "a statue";
  for (Vec3& p : geometry.positions) p.z() += 9.0;
  geometry.grid = RangeGrid{};
  geometry.viewpoint = Vec3::Zero();
  const View camera = parse_view("auto", geometry);
  EXPECT_TRUE(camera.direction.isApprox(Vec3::UnitZ(), 1e-6)) << "a depth camera looks along z";
  EXPECT_LT(camera.up.y(), -0.9) << "and has y down";
}

TEST(Render, FillsThePictureUpToTheMargin) {
  const Geometry geometry = mesh_of(testing::sphere(4, 3.0));
  RenderOptions options = small();
  options.supersample = 1;
  options.field_of_view = 0.1;
  const Image image = render({&geometry}, options);
  const double radius = 0.46 * 120;
  EXPECT_NEAR(static_cast<double>(drawn(image)), 3.14159 * radius * radius, 0.02 * 3.14 * radius * radius);
  EXPECT_EQ(image.at(80, 3), kWhite);
  EXPECT_NE(image.at(80, 7), kWhite);
}

TEST(Render, FarStraysOfACloudDoNotShrinkIt) {
  Geometry cloud = cloud_of(testing::sphere(3, 1.0));
  const std::size_t whole = drawn(render({&cloud}, small()));
  cloud.positions.push_back({500.0, 0.0, 0.0});
  EXPECT_GT(drawn(render({&cloud}, small())), whole / 2);
}

TEST(Render, ShadesFromTheUpperLeft) {
  const Geometry geometry = mesh_of(testing::sphere(4, 1.0));
  const Image image = render({&geometry}, small());
  EXPECT_GT(brightness(image, 60, 40), brightness(image, 100, 80) + 60.0);
}

TEST(Render, PointsCloseTheSurface) {
  const Geometry mesh = mesh_of(testing::sphere(4, 1.0));
  Geometry cloud = cloud_of(testing::sphere(4, 1.0));
  const std::size_t whole = drawn(render({&mesh}, small()));
  const Image image = render({&cloud}, small());
  EXPECT_NEAR(static_cast<double>(drawn(image)), static_cast<double>(whole), 0.06 * static_cast<double>(whole));
  for (int x = 40; x < 120; ++x) EXPECT_NE(image.at(x, 60), kWhite) << x;
  cloud.positions.push_back({std::nan(""), 0, 0});  // changes nothing
  cloud.positions.push_back({0, std::numeric_limits<double>::infinity(), 0});
  EXPECT_EQ(render({&cloud}, small()).pixels, image.pixels);
}

TEST(Render, DegenerateCloudsAreDrawn) {
  Geometry geometry;
  for (const std::vector<Vec3>& points : {std::vector<Vec3>{{5, 5, 5}}, std::vector<Vec3>(40, Vec3(1, 2, 3)),
                                          std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}) {
    geometry.positions = points;
    EXPECT_GT(drawn(render({&geometry}, small())), 0U) << points.size();
  }
}

TEST(Render, DrawsDotsThatTheSurfaceDoesNotHide) {
  const Geometry geometry = mesh_of(testing::sphere(3, 1.0));
  RenderItem item{&geometry};
  item.dot_color = {1, 0, 0};
  const auto red = [](const Image& image) {
    return std::count_if(image.pixels.begin(), image.pixels.end(),
                         [](const Pixel& p) { return p[0] > 150 && p[1] < 60; });
  };
  RenderOptions options = small();
  options.view = "front";
  item.dots = {{0, 0, -1}, {std::nan(""), 0, 0}};
  EXPECT_EQ(red(render(item, options)), 0);
  item.dots = {{0, 0, 1}};
  EXPECT_GT(red(render(item, options)), 20);
}

TEST(Render, RefusesWhatItCannotDraw) {
  Geometry geometry;
  EXPECT_THROW(static_cast<void>(render({})), InvalidInput);
  EXPECT_THROW(static_cast<void>(render({&geometry})), InvalidInput);
  geometry.positions = {{std::nan(""), 0, 0}};
  EXPECT_THROW(static_cast<void>(render({&geometry})), InvalidInput);
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  geometry.triangles = {{0, 1, 3}};
  EXPECT_THROW(static_cast<void>(render({&geometry}, small())), InvalidInput);
  geometry.triangles = {{0, 1, 2}};
  RenderItem item{&geometry};
  item.colors.resize(2);
  EXPECT_THROW(static_cast<void>(render(item, small())), InvalidInput);
  item.colors.clear();
  item.point_normals.resize(2);
  EXPECT_THROW(static_cast<void>(render(item, small())), InvalidInput);
  RenderOptions options = small();
  options.width = 3;
  EXPECT_THROW(static_cast<void>(render({&geometry}, options)), InvalidInput);
  EXPECT_THROW(static_cast<void>(render_scene({}, small())), InvalidInput);
}

TEST(Render, SameBytesForAnyNumberOfThreads) {
  const auto shape = testing::with_noise(testing::torus(90, 40, 2.0, 0.7), 0.01);
  Geometry range = cloud_of(shape);
  range.grid = RangeGrid{90, 40, {}};
  for (Index i = 0; i < range.size(); ++i) range.grid->pixel.push_back(i);
  for (const Geometry& geometry : {mesh_of(shape), cloud_of(shape), range}) {
    RenderItem item{&geometry};
    for (std::size_t i = 0; i < geometry.size(); i += 20) item.dots.push_back(geometry.positions[i]);
    for (std::size_t i = 0; i < geometry.size(); ++i)
      item.colors.push_back(distinct_color(static_cast<std::int64_t>(i / 50)));
    const Image one = render(item, small(), {.max_threads = 1});
    for (const int threads : {2, 3, 8}) {
      EXPECT_EQ(render(item, small(), {.max_threads = threads}).pixels, one.pixels) << threads;
    }
  }
}

TEST(Render, StopsOnRequestAndReportsMonotoneProgress) {
  const Geometry geometry = cloud_of(testing::sphere(3, 1.0));
  for (const char* phase : {"render: surface", "render: draw", "render: light"}) {
    std::stop_source source;
    RunContext context;
    context.stop = source.get_token();
    context.progress = [&](double fraction, std::string_view name) {
      if (name == phase && fraction < 1.0) source.request_stop();
    };
    EXPECT_THROW(static_cast<void>(render({&geometry}, small(), context)), Cancelled) << phase;
  }
  double last = 0.0;
  RunContext context;
  context.progress = [&](double fraction, std::string_view) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  const std::vector<RenderItem> items = {{&geometry}, {&geometry}};
  static_cast<void>(render_scene(items, small(), context));
  EXPECT_DOUBLE_EQ(last, 1.0);
}

TEST(RenderScene, PutsPanelsSideBySideOverTheirCaptions) {
  const Geometry sphere = mesh_of(testing::sphere(3, 1.0));
  RenderItem item{&sphere};
  item.title = "a sphere, ~100 %";
  item.legend = {"curvature", ColorMap::Diverging, -1.0, 1.0};
  RenderOptions options = small();
  options.width = 321;  // panels are equal, so one column of pixels is left over
  const Image image = render_scene(std::vector<RenderItem>{item, item}, options);
  EXPECT_EQ(image.width, 321);
  EXPECT_EQ(image.height, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) ASSERT_EQ(image.at(x, y), image.at(x + 160, y)) << x << "," << y;
  }
  const auto ink = [&](int y0, int y1) {
    int count = 0;
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < 160; ++x) count += image.at(x, y) == kWhite ? 0 : 1;
    }
    return count;
  };
  EXPECT_GT(ink(120 - 42, 120 - 25), 40) << "the caption";
  EXPECT_GT(ink(120 - 25, 120), 160) << "the legend";
  options.width = 60;
  EXPECT_THROW(static_cast<void>(render_scene(std::vector<RenderItem>(16, item), options)), InvalidInput);
}

TEST(RenderScene, ComparableItemsShareACamera) {
  const Geometry first = mesh_of(testing::torus(30, 12, 2.0, 0.7));
  Geometry second = first;
  second.format = "las";  // would be turned, were it alone
  const auto scene = [](const Geometry& a, const Geometry& b) {
    return render_scene(std::vector<RenderItem>{{&a}, {&b}}, small()).pixels;
  };
  EXPECT_EQ(scene(first, second), scene(first, first));
  for (Vec3& p : second.positions) p *= 1.5;
  EXPECT_NE(scene(first, second), scene(first, first));
}

}  // namespace
}  // namespace shapelight
