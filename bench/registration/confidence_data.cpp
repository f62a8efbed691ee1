// What poses look like that are right, and what those that are wrong: one CSV row per registration, for the calibration
// of the confidence (calibrate.py) and for counting how often a wrong pose is reported as good.
//
//   confidence_data MESH... [--pairs FOLDER] [--runs N] [--seed S] [--part I/N]
//
// Each run draws one of: two scans of one mesh from directions up to 150 degrees apart; scans of two different meshes;
// scans of shapes that do not tell a pose (sphere, plane, cylinder, cube, slab with a corner); two scans of one mesh
// with a start far off. Scans come with noise from 0 to 0.2 % of the diagonal, random frames, with and without a
// viewpoint.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/data/triangle_mesh.hpp"
#include "shapelight/io/io.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/pipeline/register.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/spatial/triangle_tree.hpp"
#include "shapelight/synthetic/virtual_scan.hpp"

namespace {

using namespace shapelight;
constexpr std::size_t kFewest = 500;  // [points] of a scan that is worth a run
constexpr double kDegree = std::numbers::pi / 180.0;

struct Shape {
  std::string name;
  TriangleTree surface;
  BoundingSphere sphere;
};

Shape make_shape(std::string name, const TriangleMesh& mesh) {
  return {std::move(name), TriangleTree(mesh), bounding_sphere(mesh.positions)};
}

// A grid over [0, 1]^2 bent into a surface.
template <class Place>
TriangleMesh bent_grid(std::size_t n, Place&& place) {
  TriangleMesh mesh;
  for (std::size_t j = 0; j <= n; ++j) {
    for (std::size_t i = 0; i <= n; ++i) mesh.positions.push_back(place(double(i) / double(n), double(j) / double(n)));
  }
  const auto at = [&](std::size_t i, std::size_t j) { return static_cast<Index>(j * (n + 1) + i); };
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TriangleMesh box(double x, double y, double z) {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c) mesh.positions.push_back({c & 1 ? x : -x, c & 2 ? y : -y, c & 4 ? z : -z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

std::vector<Shape> ambiguous_shapes() {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  std::vector<Shape> shapes;
  shapes.push_back(make_shape("sphere", bent_grid(200, [](double u, double v) {
                                const double a = kTurn * u, b = std::numbers::pi * (v - 0.5);
                                return Vec3(std::cos(a) * std::cos(b), std::sin(b), std::sin(a) * std::cos(b));
                              })));
  shapes.push_back(make_shape("plane", box(1.0, 1.0, 0.0)));
  shapes.push_back(make_shape("cylinder", bent_grid(200, [](double u, double v) {
                                return Vec3(0.4 * std::cos(kTurn * u), 2.0 * v - 1.0, 0.4 * std::sin(kTurn * u));
                              })));
  shapes.push_back(make_shape("cone", bent_grid(200, [](double u, double v) {
                                return Vec3(0.6 * v * std::cos(kTurn * u), 1.0 - 2.0 * v,
                                            0.6 * v * std::sin(kTurn * u));
                              })));
  shapes.push_back(make_shape("cube", box(1.0, 1.0, 1.0)));
  shapes.push_back(make_shape("slab", box(1.0, 0.6, 0.2)));
  return shapes;
}

class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t run) : seed_(seed), run_(run) {}
  double uniform(double low, double high) { return low + (high - low) * random01(seed_, run_, next_++); }
  std::size_t below(std::size_t n) { return std::min(n - 1, static_cast<std::size_t>(uniform(0.0, double(n)))); }

 private:
  std::uint64_t seed_, run_, next_ = 0;
};

struct View {
  VirtualScan scan;
  std::string shape;
};

View take(const Shape& shape, double azimuth, double elevation, double noise, bool keeps_viewpoint, Draw& draw) {
  VirtualScanOptions options;
  options.width = options.height = 200;
  options.noise = noise * 2.0 * shape.sphere.radius;
  options.dropout = 0.02;
  options.random_pose = true;
  options.seed = static_cast<std::uint64_t>(draw.uniform(0.0, 1e9));
  View view{virtual_scan(shape.surface, camera_on_sphere(shape.sphere, azimuth, elevation), options), shape.name};
  if (!keeps_viewpoint) view.scan.geometry.viewpoint.reset();
  return view;
}

struct Case {
  std::string kind;
  View source, target;
  std::optional<RigidTransform> truth;  // none: there is none
  std::optional<RigidTransform> init;
};

RigidTransform random_turn(Draw& draw, double angle) {
  Vec3 axis(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
  RigidTransform turn = RigidTransform::Identity();
  turn.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return turn;
}

RigidTransform far_off(const RigidTransform& truth, const Geometry& target, Draw& draw) {
  const Vec3 middle = bounding_box(target.positions).center();
  RigidTransform about = random_turn(draw, draw.uniform(30.0, 180.0) * kDegree);
  about.translation() = middle - about.linear() * middle;
  return about * truth;
}

Case draw_case(const std::vector<Shape>& meshes, const std::vector<Shape>& ambiguous, Draw& draw) {
  const double kind = draw.uniform(0.0, 1.0);
  const double noise = 0.0005 * std::floor(draw.uniform(0.0, 5.0));
  const bool viewpoint = draw.uniform(0.0, 1.0) < 0.5;
  const double azimuth = draw.uniform(0.0, 360.0) * kDegree;
  const double elevation = draw.uniform(-30.0, 50.0) * kDegree;
  const bool is_ambiguous = kind >= 0.7 && kind < 0.85;
  const std::vector<Shape>& shapes = is_ambiguous ? ambiguous : meshes;
  const Shape& first = shapes[draw.below(shapes.size())];
  const Shape* second = &first;
  if (kind >= 0.45 && kind < 0.7) {
    while (second == &first) second = &shapes[draw.below(shapes.size())];
  }
  const double apart = draw.uniform(5.0, 150.0) * kDegree;
  Case c{is_ambiguous       ? "ambiguous"
         : second != &first ? "different"
         : kind >= 0.85     ? "bad start"
                            : "same",
         take(*second, azimuth + apart, elevation + draw.uniform(-20.0, 20.0) * kDegree, noise, viewpoint, draw),
         take(first, azimuth, elevation, noise, viewpoint, draw),
         {},
         {}};
  if (second != &first) return c;
  c.truth = c.target.scan.T_mesh_scan.inverse() * c.source.scan.T_mesh_scan;
  if (kind >= 0.85) c.init = far_off(*c.truth, c.target.scan.geometry, draw);
  return c;
}

// Real scans, and the motions between those that belong together.
struct RealPair {
  std::string name;
  Geometry source, target;
  RigidTransform T_target_source;
};

std::vector<RealPair> read_pairs(const std::filesystem::path& folder) {
  std::vector<RealPair> pairs;
  std::ifstream list(folder / "pairs.csv");
  std::string line;
  std::getline(list, line);
  while (std::getline(list, line)) {
    std::istringstream cells(line);
    std::string name, source, target, transform;
    std::getline(cells, name, ',');
    std::getline(cells, source, ',');
    std::getline(cells, target, ',');
    std::getline(cells, transform, ',');
    ReadOptions options;
    if (name.starts_with("kinect")) options.intrinsics = CameraIntrinsics{585.0, 585.0, 320.0, 240.0};
    pairs.push_back({name, read_geometry(folder / source, options), read_geometry(folder / target, options),
                     read_transform(folder / transform)});
  }
  return pairs;
}

View thinned(const std::string& name, const Geometry& geometry, std::uint64_t count, bool keeps_viewpoint, Draw& draw) {
  SampleOptions random;
  random.method = SamplingMethod::Random;
  random.seed = static_cast<std::uint64_t>(draw.uniform(0.0, 1e9));
  SampleSize size;
  size.count = std::min<std::uint64_t>(count, geometry.size() / 2);
  View view{{select_points(geometry, sample(geometry, size, random).indices), RigidTransform::Identity()}, name};
  if (!keeps_viewpoint) view.scan.geometry.viewpoint.reset();
  const RigidTransform T_scan_file = random_turn(draw, draw.uniform(0.0, std::numbers::pi));
  transform_geometry(view.scan.geometry, T_scan_file);
  view.scan.T_mesh_scan = T_scan_file.inverse();  // "mesh": the file's frame
  return view;
}

// Pairs of one place overlap with each other: the depth frames show the red kitchen as well.
std::string place_of(const std::string& name) {
  const std::string place = name.substr(0, name.find('_'));
  return place == "kinect" ? "redkitchen" : place;
}

Case draw_real_case(const std::vector<RealPair>& pairs, Draw& draw) {
  const double kind = draw.uniform(0.0, 1.0);
  const bool viewpoint = draw.uniform(0.0, 1.0) < 0.5;
  const std::size_t first = draw.below(pairs.size());
  std::size_t second = first;
  while (kind >= 0.7 && place_of(pairs[second].name) == place_of(pairs[first].name)) second = draw.below(pairs.size());
  const auto count = static_cast<std::uint64_t>(draw.uniform(10000.0, 30000.0));
  Case c{kind >= 0.7   ? "real, different"
         : kind >= 0.4 ? "real, bad start"
                       : "real",
         thinned(pairs[second].name, pairs[second].source, count, viewpoint, draw),
         thinned(pairs[first].name, pairs[first].target, count, viewpoint, draw),
         {},
         {}};
  if (second != first) return c;
  c.truth = c.target.scan.T_mesh_scan.inverse() * pairs[first].T_target_source * c.source.scan.T_mesh_scan;
  if (kind >= 0.4) c.init = far_off(*c.truth, c.target.scan.geometry, draw);
  return c;
}

void report(std::uint64_t run, const Case& c, const RegisterResult& result) {
  const PoseAssessment& pose = result.assessment;
  const BoundingBox box = bounding_box(c.source.scan.geometry.positions);
  double rotation = -1.0, shift = -1.0;
  if (c.truth) {
    rotation = Eigen::AngleAxisd(c.truth->linear().transpose() * result.T_target_source.linear()).angle() / kDegree;
    shift = (*c.truth * box.center() - result.T_target_source * box.center()).norm() / box.diagonal();
  }
  fmt::print("{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", run, c.kind, c.source.shape,
             c.target.shape, c.source.scan.geometry.viewpoint.has_value() ? 1 : 0, rotation, shift, pose.overlap,
             pose.gate / box.diagonal(), pose.residual / box.diagonal(), pose.contrast, pose.normal_agreement,
             pose.in_free_space, pose.conditioning, pose.weakest.uncertainty / box.diagonal(), pose.reciprocal.share,
             result.fit, result.rival_fit, pose.rival_weight, pose.confidence);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  std::vector<Shape> meshes;
  std::vector<RealPair> pairs;
  std::uint64_t runs = 200, seed = 1, part = 0, parts = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--pairs" && i + 1 < argc) {
      pairs = read_pairs(argv[++i]);
    } else if (argument == "--runs" && i + 1 < argc) {
      runs = std::stoull(argv[++i]);
    } else if (argument == "--seed" && i + 1 < argc) {
      seed = std::stoull(argv[++i]);
    } else if (argument == "--part" && i + 1 < argc) {
      const std::string text = argv[++i];
      part = std::stoull(text);
      parts = std::stoull(text.substr(text.find('/') + 1));
    } else {
      const Geometry geometry = read_geometry(argument);
      meshes.push_back(
          make_shape(std::filesystem::path(argument).stem().string(), {geometry.positions, geometry.triangles}));
    }
  }
  if (meshes.size() < 2) throw InvalidInput("expected two meshes or more");
  const std::vector<Shape> ambiguous = ambiguous_shapes();
  fmt::print(
      "run,kind,source,target,viewpoint,rotation_deg,shift,overlap,gate,residual,contrast,normal_agreement,"
      "in_free_space,conditioning,uncertainty,reciprocal_share,fit,rival_fit,rival_weight,confidence\n");
  for (std::uint64_t i = part; i < runs; i += parts) {
    Draw draw(seed, i);
    const bool is_real = !pairs.empty() && draw.uniform(0.0, 1.0) < 0.5;
    const Case c = is_real ? draw_real_case(pairs, draw) : draw_case(meshes, ambiguous, draw);
    if (std::min(c.source.scan.geometry.size(), c.target.scan.geometry.size()) < kFewest) continue;  // seen edge-on
    report(i, c, register_scans(c.source.scan.geometry, c.target.scan.geometry, c.init, {}, {.max_threads = 1}));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "confidence_data: {}\n", error.what());
    return 1;
  }
}
