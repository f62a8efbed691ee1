#include "scan_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/random.hpp"
#include "shapelight/io/io.hpp"
#include "shapelight/io/transform.hpp"
#include "shapelight/synthetic/scan_pair.hpp"

namespace shapelight::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLargestShift = 0.03;  // of the target's diagonal
const RunContext kOneThread{1, {}, {}};

Scan make_scan(const Geometry& geometry) {
  BuiltGraph built = build_graph(geometry, {}, kOneThread);
  const SurfaceGraph& graph = built.graph;
  std::vector<Vec3> position, normal;
  std::vector<Index> place_of_vertex(graph.size(), kNoIndex);
  std::vector<std::uint8_t> is_boundary;
  for (std::size_t v = 0; v < graph.size(); ++v) {
    if (graph.outlier[v]) continue;
    place_of_vertex[v] = static_cast<Index>(position.size());
    position.push_back(graph.position[v]);
    normal.push_back(graph.normal[v]);
    is_boundary.push_back(graph.boundary[v]);
  }
  const Vec3 origin = graph.origin;
  RegistrationCloud full(std::move(position), std::move(normal), kOneThread);
  if (geometry.viewpoint) full.viewpoint = *geometry.viewpoint - origin;
  return {std::move(built), geometry.kind(), PreparedScan{origin, std::move(full), RegistrationCloud({}), {}},
          std::move(place_of_vertex), std::move(is_boundary)};
}

Pair make_pair(const std::string& name, const std::string& truth, const Geometry& source, const Geometry& target,
               const RigidTransform& T_target_source) {
  Pair pair{name, truth, make_scan(source), make_scan(target), T_target_source, Vec3::Zero(), 0.0};
  pair.T_target_source.translation() = T_target_source * pair.source.prepared.origin - pair.target.prepared.origin;
  const RegistrationCloud &from = pair.source.prepared.full, &to = pair.target.prepared.full;
  double close = 0.0;
  for (const Vec3& p : from.position) {
    if (to.tree.nearest(pair.T_target_source * p).distance_sq > 4.0 * to.spacing * to.spacing) continue;
    pair.middle += p;
    ++close;
  }
  pair.middle /= std::max(close, 1.0);
  pair.overlap = close / static_cast<double>(from.size());
  return pair;
}

}  // namespace

Pair read_pair(const std::string& name, const std::string& source, const std::string& target,
               const std::string& transform) {
  return make_pair(name, "published", read_geometry(source), read_geometry(target), read_transform(transform));
}

Pair scan_mesh(const std::string& name, const std::string& mesh, double overlap, double noise, double azimuth,
               int pixels) {
  const Geometry geometry = read_geometry(mesh);
  const TriangleTree surface({geometry.positions, geometry.triangles});
  ScanPairOptions options;
  options.overlap = overlap;
  options.azimuth = azimuth * kDegree;
  options.scan.width = options.scan.height = pixels;
  options.scan.noise = noise * bounding_box(geometry.positions).diagonal();
  options.scan.dropout = 0.01;
  options.scan.random_pose = true;
  for (const char letter : name)
    options.scan.seed = random_bits(options.scan.seed, 0, static_cast<std::uint64_t>(letter));
  const ScanPair scans = scan_pair(surface, bounding_sphere(geometry.positions), options);
  return make_pair(name, "exact", scans.source.geometry, scans.target.geometry, scans.T_target_source);
}

std::vector<Start> starting_poses(const Pair& pair, int count, double low_deg, double high_deg) {
  std::vector<Start> starts;
  const Vec3 middle = pair.T_target_source * pair.middle;
  for (int i = 0; i < count; ++i) {
    const auto draw = [&](std::uint64_t stream) { return random01(2013, stream, static_cast<std::uint64_t>(i)); };
    const double z = 2.0 * draw(0) - 1.0, around = 2.0 * std::numbers::pi * draw(1), r = std::sqrt(1.0 - z * z);
    Start start;
    start.angle_deg = low_deg + (high_deg - low_deg) * (i + draw(2)) / count;
    RigidTransform turn = RigidTransform::Identity();
    turn.linear() = Eigen::AngleAxisd(start.angle_deg * kDegree, Vec3(r * std::cos(around), r * std::sin(around), z))
                        .toRotationMatrix();
    const Vec3 direction = Vec3(draw(3) - 0.5, draw(4) - 0.5, draw(5) - 0.5).normalized();
    turn.translation() =
        middle - turn.linear() * middle + kLargestShift * pair.target.prepared.full.diagonal * draw(6) * direction;
    start.T_target_source = turn * pair.T_target_source;
    starts.push_back(start);
  }
  return starts;
}

PoseError error_of(const Pair& pair, const RigidTransform& T_target_source) {
  const Eigen::Matrix3d apart = pair.T_target_source.linear().transpose() * T_target_source.linear();
  const Vec3 shift = T_target_source * pair.middle - pair.T_target_source * pair.middle;
  return {std::abs(Eigen::AngleAxisd(apart).angle()) / kDegree, shift.norm() / pair.target.prepared.full.diagonal};
}

}  // namespace shapelight::bench
