#include "simplify/vertex_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "simplify/star_shape.hpp"

namespace shapelight::simplification {
namespace {

constexpr double kTangential = 0.003;  // weight of a sample's displacement along its face
constexpr double kOverRelaxation = 1.4;
constexpr double kBackward = 0.06;  // weight of the vertex's own distance from the input
constexpr double kRegularisation = 1e-4;
constexpr double kMinGain = 1e-7;
constexpr ShapeLimits kLimits{.min_cosine = 0.5, .min_quality = 0.02};
constexpr std::size_t kChunk = 64;

// The planes on the edges of a triangle, upright, looking inwards.
struct InsideTest {
  explicit InsideTest(const LocalTriangle& t) : triangle(t) {
    for (int k = 0; k < 3; ++k) inward[k] = t.normal.cross(t.corner[(k + 1) % 3] - t.corner[k]);
  }
  [[nodiscard]] bool holds(const Vec3& x) const {
    return inward[0].dot(x - triangle.corner[0]) >= 0.0 && inward[1].dot(x - triangle.corner[1]) >= 0.0 &&
           inward[2].dot(x - triangle.corner[2]) >= 0.0;
  }
  const LocalTriangle& triangle;
  Vec3 inward[3];
};

void add_face(const MeasuredMesh& measured, Index f, Index v, double normal_weight, FitModel& model) {
  const LiveMesh& mesh = measured.mesh;
  const Vec3& origin = mesh.position[v];
  const LocalTriangle t = triangle_with(mesh, f, v, origin, origin);
  if (t.double_area <= 0.0) return;
  const int k = mesh.face(f)[0] == v ? 0 : mesh.face(f)[1] == v ? 1 : 2;
  const Vec3 gradient = t.normal.cross(t.corner[(k + 2) % 3] - t.corner[(k + 1) % 3]) / t.double_area;
  const Eigen::Matrix3d along_normal = t.normal * t.normal.transpose();
  Eigen::Matrix3d inside_part = along_normal;
  inside_part.diagonal().array() += kTangential;
  double inside = 0.0, clamped = 0.0, turning = 0.0;
  Vec3 normals = Vec3::Zero();
  const InsideTest test(t);
  measured.for_samples(f, [&](const SurfaceSample& s) {
    const Vec3 x = s.position - origin;
    const bool is_inside = test.holds(x);
    const Vec3 q = is_inside ? Vec3(x - t.normal.dot(x - t.corner[0]) * t.normal)
                             : closest_point_on_triangle(x, t.corner[0], t.corner[1], t.corner[2]);
    const double hat = std::max(0.0, 1.0 + gradient.dot(q));
    model.g += s.weight * hat * (x - q);
    (is_inside ? inside : clamped) += s.weight * hat * hat;
    model.weight += s.weight;
    if (s.turn > 0.0F) {
      turning += s.weight;
      normals += s.weight * Vec3(s.normal[0], s.normal[1], s.normal[2]);
    }
  });
  model.A += inside * inside_part;
  model.A.diagonal().array() += clamped;
  const double lambda_sq = normal_weight * normal_weight;
  model.A += lambda_sq * turning * gradient.squaredNorm() * along_normal;
  model.g -= lambda_sq * gradient.dot(normals) * t.normal;
}

void add_line(const MeasuredMesh& measured, Index edge, Index v, FitModel& model) {
  const LiveMesh& mesh = measured.mesh;
  const Vec3& origin = mesh.position[v];
  const Vec3 far = mesh.position[mesh.other_end(edge, v)] - origin;
  const double length_sq = far.squaredNorm();
  if (length_sq <= 0.0) return;
  Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - far * far.transpose() / length_sq;
  across.diagonal().array() += kTangential;
  measured.for_line_samples(edge, [&](const LineSample& s) {
    const Vec3 x = s.position - origin;
    const double t = x.dot(far) / length_sq;
    const double clamped = std::clamp(t, 0.0, 1.0);
    const double hat = 1.0 - clamped;
    model.g += s.weight * hat * (x - clamped * far);
    if (t == clamped) {
      model.A += s.weight * hat * hat * across;
    } else {
      model.A.diagonal().array() += s.weight * hat * hat;
    }
  });
}

// Pull of the input surface on the vertex itself.
struct Backward {
  double weight = 0.0;
  double error_at(const Vec3& place, Index v, InputSurface& input) const {
    return weight * input.closest(place, v).distance_sq;
  }
};

void fit(MeasuredMesh& measured, Index v, double normal_weight, InputSurface& input, StarTrial& trial) {
  const LiveMesh& mesh = measured.mesh;
  if (mesh.locked[v] || !mesh.is_alive(v)) return;
  const Vec3 p = mesh.position[v];
  FitModel model = fit_model(measured, v, normal_weight);
  if (!(model.weight > 0.0)) return;
  const Backward backward{kBackward * model.weight / 3.0};
  const TriangleTree::Hit hit = input.closest(p, v);  // a copy: the next search replaces it
  const Vec3 n = input.normal(hit.triangle);
  model.A += backward.weight * n * n.transpose();
  model.g += backward.weight * (hit.point - p);
  model.A.diagonal().array() += kRegularisation * model.A.trace();
  Vec3 step = kOverRelaxation * model.A.inverse() * model.g;
  if (!step.allFinite()) return;
  double longest_sq = 0.0;
  for (const Index f : mesh.star(v)) {
    for (const Index w : mesh.face(f)) longest_sq = std::max(longest_sq, (mesh.position[w] - p).squaredNorm());
  }
  const double longest = std::sqrt(longest_sq);
  if (step.norm() < 1e-7 * longest) return;
  step *= std::min(1.0, 0.5 * longest / step.norm());
  trial.begin(measured, v);
  const double now = trial.energy_now() + backward.weight * hit.distance_sq;
  for (const double s : {1.0, 0.5, 0.25}) {
    const Vec3 place = p + s * step;
    const double energy = trial.energy_at(place, mesh.source[v]);
    if (!(energy < now)) continue;
    if (energy + backward.error_at(place, v, input) < now * (1.0 - kMinGain)) {
      trial.accept(measured);
      return;
    }
  }
}

}  // namespace

FitModel fit_model(const MeasuredMesh& measured, Index v, double normal_weight) {
  FitModel model;
  for (const Index f : measured.mesh.star(v)) add_face(measured, f, v, normal_weight, model);
  if (measured.mesh.is_on_line(v)) {
    for (const Index e : measured.mesh.line_edges(v)) add_line(measured, e, v, model);
  }
  return model;
}

void StarTrial::begin(const MeasuredMesh& measured, Index v) {
  measured_ = &measured;
  v_ = v;
  const LiveMesh& mesh = measured.mesh;
  energy_now_ = measured.gather(mesh.star(v), mesh.position[v], block_, ids_);
  if (mesh.is_on_line(v)) {
    for (const Index e : mesh.line_edges(v)) energy_now_ += measured.line_energy(e);
  }
  shape_.measure(mesh, v);
}

double StarTrial::energy_at(const Vec3& place, Index source) {
  const LiveMesh& mesh = measured_->mesh;
  const Vec3& origin = mesh.position[v_];
  place_ = place;
  block_.reset();
  std::int32_t id = 0;
  for (const Index f : mesh.star(v_)) {
    const LocalTriangle after = triangle_with(mesh, f, v_, place, origin);
    if (!shape_.keeps(static_cast<std::size_t>(id), after, kLimits)) return std::numeric_limits<double>::infinity();
    if (source != kNoIndex) {
      const Triangle& t = mesh.face(f);
      const auto corner = [&](int k) { return t[k] == v_ ? source : mesh.source[t[k]]; };
      if (!measured_->agrees_with_input(after.normal, corner(0), corner(1), corner(2))) {
        return std::numeric_limits<double>::infinity();
      }
    }
    block_.offer(after, id++);
  }
  return block_.total() + line_energy_at(place);
}

bool StarTrial::force(MeasuredMesh& measured, Index v, const Vec3& place) {
  begin(measured, v);
  place_ = place;
  block_.reset();
  std::int32_t id = 0;
  for (const Index f : measured.mesh.star(v)) {
    block_.offer(triangle_with(measured.mesh, f, v, place, measured.mesh.position[v]), id++);
  }
  const auto samples_end = block_.best.begin() + static_cast<std::ptrdiff_t>(block_.size());
  if (std::find(block_.best.begin(), samples_end, -1) != samples_end) return false;
  accept(measured);
  return true;
}

double StarTrial::line_energy_at(const Vec3& place) const {
  const LiveMesh& mesh = measured_->mesh;
  if (!mesh.is_on_line(v_)) return 0.0;
  const auto& [first, second] = mesh.line_edges(v_);
  const Vec3& a = mesh.position[mesh.other_end(first, v_)];
  const Vec3& b = mesh.position[mesh.other_end(second, v_)];
  double sum = 0.0;
  for (const Index e : {first, second}) {
    measured_->for_line_samples(e, [&](const LineSample& s) {
      sum += s.weight * std::min(segment_distance_sq(s.position, place, a), segment_distance_sq(s.position, place, b));
    });
  }
  return sum;
}

void StarTrial::accept(MeasuredMesh& measured) const {
  measured.mesh.position[v_] = place_;
  measured.assign(measured.mesh.star(v_), block_, ids_);
  if (measured.mesh.is_on_line(v_)) {
    measured.assign_line(measured.mesh.line_edges(v_)[0], measured.mesh.line_edges(v_)[1]);
  }
}

const TriangleTree::Hit& InputSurface::closest(const Vec3& p, Index v) {
  Search& last = last_[v];
  if (last.from != p) last = {p, tree_.closest(p, last.hit.triangle)};
  return last.hit;
}

Vec3 InputSurface::normal(Index face) const {
  const Triangle& t = surface_.triangles[face];
  const auto& p = surface_.positions;
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).normalized();
}

double InputSurface::error_of_removal(const LiveMesh& mesh, Index u, Index v) const {
  Index hint = last_[u].hit.triangle;
  const auto distance_sq = [&](const Vec3& p) {
    const TriangleTree::Hit hit = tree_.closest(p, hint);
    hint = hit.triangle;
    return hit.distance_sq;
  };
  double error = 0.0;
  for (const Index f : mesh.star(u)) {
    const Triangle& t = mesh.face(f);
    if (t[0] == v || t[1] == v || t[2] == v) continue;
    const LocalTriangle after = triangle_with(mesh, f, u, mesh.position[v], Vec3::Zero());
    const auto& [a, b, c] = after.corner;
    const double sum = distance_sq((a + b + c) / 3.0) + distance_sq(0.5 * (a + b)) + distance_sq(0.5 * (b + c)) +
                       distance_sq(0.5 * (c + a));
    error += 0.5 * after.double_area * sum / 4.0;
  }
  return error;
}

std::vector<std::size_t> put_folded_back(MeasuredMesh& measured, std::span<const Index> vertices,
                                         std::span<const Vec3> before, const RunContext& context) {
  const LiveMesh& mesh = measured.mesh;
  std::vector<std::size_t> back;
  StarTrial trial;
  while (true) {  // where one has gone back, another's faces may fold
    std::vector<std::uint8_t> folded(vertices.size(), 0);
    parallel::for_chunks(
        context, vertices.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const Index v = vertices[i];
            folded[i] = mesh.position[v] != before[i] && folds_faces(mesh, v, v);
          }
        },
        kChunk);
    const std::size_t so_far = back.size();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      poll(context, i);
      if (folded[i] != 0 && trial.force(measured, vertices[i], before[i])) back.push_back(i);
    }
    if (back.size() == so_far) return back;
  }
}

void fit_vertices(MeasuredMesh& measured, std::span<const Index> vertices, double normal_weight, InputSurface& input,
                  const RunContext& context) {
  for (const std::vector<Index>& independent : independent_classes(measured.mesh, vertices, context)) {
    std::vector<Vec3> before(independent.size());
    parallel::for_chunks(
        context, independent.size(),
        [&](std::size_t begin, std::size_t end) {
          StarTrial trial;
          for (std::size_t i = begin; i < end; ++i) {
            before[i] = measured.mesh.position[independent[i]];
            fit(measured, independent[i], normal_weight, input, trial);
          }
        },
        kChunk);
    (void)put_folded_back(measured, independent, before, context);
  }
}

}  // namespace shapelight::simplification
