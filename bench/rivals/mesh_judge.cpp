// Measures how far two triangle meshes are apart, with no code of shapelight's, in double precision.
//   mesh_judge REFERENCE.off TEST.off [SAMPLES_PER_VERTEX = 10]
// On each surface SAMPLES_PER_VERTEX x (vertices of REFERENCE) points, one in each of as many stretches of equal area
// along the triangles; closest points on the other surface are exact. Prints JSON: root mean square of the distances,
// of the angles between the triangles' normals, and the largest distance, over samples and vertices; distances as
// shares of REFERENCE's bounding box diagonal.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "off_mesh.hpp"

namespace {

using rivals::OffMesh;
using rivals::Point;

Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Corners {
  Point a, b, c;
};

Corners corners(const OffMesh& mesh, std::size_t triangle) {
  const rivals::Triangle& t = mesh.triangles[triangle];
  return {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
}

/// Twice the area long.
Point normal(const Corners& t) { return cross(t.b - t.a, t.c - t.a); }

double segment_distance_sq(const Point& p, const Point& a, const Point& b) {
  const Point ab = b - a, ap = p - a;
  const double length_sq = dot(ab, ab);
  const double s = length_sq > 0 ? std::clamp(dot(ap, ab) / length_sq, 0.0, 1.0) : 0.0;
  const Point off = {ap[0] - s * ab[0], ap[1] - s * ab[1], ap[2] - s * ab[2]};
  return dot(off, off);
}

/// To the plane where the foot lies inside, else to the nearest side; right for needles and points too.
double triangle_distance_sq(const Point& p, const Corners& t) {
  const Point n = normal(t), ap = p - t.a;
  const double n_sq = dot(n, n);
  if (n_sq > 0 && dot(n, cross(t.b - t.a, ap)) >= 0 && dot(n, cross(t.c - t.b, p - t.b)) >= 0 &&
      dot(n, cross(t.a - t.c, p - t.c)) >= 0)
    return dot(n, ap) * dot(n, ap) / n_sq;
  return std::min(
      {segment_distance_sq(p, t.a, t.b), segment_distance_sq(p, t.b, t.c), segment_distance_sq(p, t.c, t.a)});
}

struct Box {
  Point low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  void add(const Point& p) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  double distance_sq(const Point& p) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double off = std::max({low[axis] - p[axis], 0.0, p[axis] - high[axis]});
      sum += off * off;
    }
    return sum;
  }
};

struct Closest {
  double distance_sq = std::numeric_limits<double>::infinity();
  std::size_t triangle = 0;
};

/// Boxes in boxes: node i has its children at i + 1 and `right`, a leaf has right == 0.
class BoxTree {
 public:
  explicit BoxTree(const OffMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    build(0, order_.size());
  }

  /// `closest` may start from a guess; the nearer the guess, the faster.
  void find(const Point& p, Closest& closest) const {
    std::size_t stack[128];
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::size_t at = stack[--depth];
      const Node& node = nodes_[at];
      if (node.box.distance_sq(p) >= closest.distance_sq) continue;
      if (node.right == 0) {
        for (std::size_t i = node.begin; i < node.end; ++i) improve(p, order_[i], closest);
        continue;
      }
      const bool left_first = nodes_[at + 1].box.distance_sq(p) <= nodes_[node.right].box.distance_sq(p);
      stack[depth++] = left_first ? node.right : at + 1;
      stack[depth++] = left_first ? at + 1 : node.right;
    }
  }

  void improve(const Point& p, std::size_t triangle, Closest& closest) const {
    const double distance_sq = triangle_distance_sq(p, corners(mesh_, triangle));
    if (distance_sq < closest.distance_sq) closest = {distance_sq, triangle};
  }

 private:
  struct Node {
    Box box;
    std::size_t begin, end, right;
  };

  void build(std::size_t begin, std::size_t end) {
    const std::size_t at = nodes_.size();
    nodes_.push_back({{}, begin, end, 0});
    Box box, centers;
    for (std::size_t i = begin; i < end; ++i) {
      const Corners t = corners(mesh_, order_[i]);
      for (const Point& p : {t.a, t.b, t.c}) box.add(p);
      centers.add(center(t));
    }
    nodes_[at].box = box;
    if (end - begin <= 4) return;
    const Point extent = centers.high - centers.low;
    const int axis = static_cast<int>(std::max_element(extent.begin(), extent.end()) - extent.begin());
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::size_t i, std::size_t j) {
                       return center(corners(mesh_, i))[axis] < center(corners(mesh_, j))[axis];
                     });
    build(begin, middle);
    nodes_[at].right = nodes_.size();
    build(middle, end);
  }

  static Point center(const Corners& t) {
    return {t.a[0] + t.b[0] + t.c[0], t.a[1] + t.b[1] + t.c[1], t.a[2] + t.b[2] + t.c[2]};
  }

  const OffMesh& mesh_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

/// Uniform in [0, 1): a hash of the index, so that a run can be repeated.
double uniform(std::uint64_t index) {
  index += 0x9e3779b97f4a7c15ULL;
  index = (index ^ (index >> 30)) * 0xbf58476d1ce4e5b9ULL;
  index = (index ^ (index >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((index ^ (index >> 31)) >> 11) * 0x1p-53;
}

struct OneWay {
  double mean = 0, rms = 0, max = 0, normal_rms = 0;
};

double angle_deg(const Point& m, const Point& n) {
  return std::atan2(std::sqrt(dot(cross(m, n), cross(m, n))), dot(m, n)) * 180 / 3.14159265358979323846;
}

/// From points on `from` to the surface in `tree`.
OneWay one_way(const OffMesh& from, const OffMesh& to, const BoxTree& tree, std::size_t num_samples) {
  std::vector<double> area_up_to(from.triangles.size());
  double area = 0;
  for (std::size_t i = 0; i < area_up_to.size(); ++i) {
    const Point n = normal(corners(from, i));
    area_up_to[i] = area += std::sqrt(dot(n, n));
  }
  OneWay result;
  double sum = 0, sum_sq = 0, angle_sum_sq = 0, max_sq = 0;
  std::size_t triangle = 0, guess = 0;
  const auto closest_to = [&](const Point& p) {
    Closest closest;
    tree.improve(p, guess, closest);
    tree.find(p, closest);
    guess = closest.triangle;
    max_sq = std::max(max_sq, closest.distance_sq);
    return closest;
  };
  for (std::size_t k = 0; k < num_samples; ++k) {
    const double at = (static_cast<double>(k) + uniform(3 * k)) / static_cast<double>(num_samples) * area;
    while (triangle + 1 < area_up_to.size() && area_up_to[triangle] <= at) ++triangle;
    const Corners t = corners(from, triangle);
    const double root = std::sqrt(uniform(3 * k + 1)), v = root * uniform(3 * k + 2), u = 1 - root;
    Point p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = u * t.a[axis] + (1 - u - v) * t.b[axis] + v * t.c[axis];
    const Closest closest = closest_to(p);
    const double angle = angle_deg(normal(t), normal(corners(to, closest.triangle)));
    sum += std::sqrt(closest.distance_sq);
    sum_sq += closest.distance_sq;
    angle_sum_sq += angle * angle;
  }
  for (const Point& p : from.points) closest_to(p);
  const double count = static_cast<double>(num_samples);
  return {sum / count, std::sqrt(sum_sq / count), std::sqrt(max_sq), std::sqrt(angle_sum_sq / count)};
}

double mean_square(double a, double b) { return std::sqrt(0.5 * (a * a + b * b)); }

void print(const char* name, const OneWay& way, double diagonal, const char* end) {
  std::printf("\"%s\": {\"mean\": %.9g, \"rms\": %.9g, \"max\": %.9g, \"normal_rms_deg\": %.9g}%s", name,
              way.mean / diagonal, way.rms / diagonal, way.max / diagonal, way.normal_rms, end);
}

int run(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: mesh_judge REFERENCE.off TEST.off [SAMPLES_PER_VERTEX]\n");
    return 2;
  }
  const OffMesh reference = rivals::read_off(argv[1]), test = rivals::read_off(argv[2]);
  if (reference.triangles.empty() || test.triangles.empty()) throw std::runtime_error("expected triangles in both");
  const std::size_t num_samples = reference.points.size() * (argc == 4 ? std::strtoul(argv[3], nullptr, 10) : 10);
  Box box;
  for (const Point& p : reference.points) box.add(p);
  const Point extent = box.high - box.low;
  const double diagonal = std::sqrt(dot(extent, extent));
  const OneWay forward = one_way(reference, test, BoxTree(test), num_samples);
  const OneWay backward = one_way(test, reference, BoxTree(reference), num_samples);
  const OneWay both = {0.5 * (forward.mean + backward.mean), mean_square(forward.rms, backward.rms),
                       std::max(forward.max, backward.max), mean_square(forward.normal_rms, backward.normal_rms)};
  std::printf("{");
  print("forward", forward, diagonal, ", ");
  print("backward", backward, diagonal, ", ");
  print("symmetric", both, diagonal, "}\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mesh_judge: %s\n", error.what());
    return 1;
  }
}
