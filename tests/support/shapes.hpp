#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "shapelight/core/types.hpp"

/// Surfaces with curvature in closed form, as triangle meshes with outward faces.
namespace shapelight::testing {

/// A mesh and, per vertex, the exact normal and principal curvatures (k1 >= k2, convex positive).
struct Shape {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<Vec3> normals;
  std::vector<double> k1, k2;

  void add(const Vec3& position, const Vec3& normal, double larger, double smaller) {
    positions.push_back(position);
    normals.push_back(normal);
    k1.push_back(larger);
    k2.push_back(smaller);
  }
};

/// Standard normal number, a pure function of its arguments.
inline double gaussian(std::uint64_t seed, std::uint64_t stream, std::uint64_t id) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random01(seed, 2 * stream, id)));
  return radius * std::cos(2.0 * std::numbers::pi * random01(seed, 2 * stream + 1, id));
}

/// Two triangles per cell of a grid of columns x rows vertices; the index wraps where asked.
inline void add_grid_faces(Shape& shape, Index columns, Index rows, bool wrap_columns, bool wrap_rows) {
  for (Index r = 0; r + (wrap_rows ? 0 : 1) < rows; ++r) {
    for (Index c = 0; c + (wrap_columns ? 0 : 1) < columns; ++c) {
      const Index c1 = (c + 1) % columns, r1 = (r + 1) % rows;
      const Index a = r * columns + c, b = r * columns + c1, d = r1 * columns + c, e = r1 * columns + c1;
      shape.triangles.push_back({a, b, e});
      shape.triangles.push_back({a, e, d});
    }
  }
}

/// z = (a x^2 + b y^2) / 2 over a square patch of nearly equilateral triangles, normals up; `jitter` in grid steps.
inline Shape height_field(std::string name, Index side, double step, double a, double b, double jitter = 0.0) {
  Shape shape;
  shape.name = std::move(name);
  for (Index r = 0; r < side; ++r) {
    for (Index c = 0; c < side; ++c) {
      const Index id = r * side + c;
      const double shift = 0.5 * (r % 2) + jitter * (2.0 * random01(1, 0, id) - 1.0);
      const double x = step * (c + shift - 0.5 * side);
      const double y = step * std::sqrt(0.75) * (r + jitter * (2.0 * random01(1, 1, id) - 1.0) - 0.5 * side);
      const double gx = a * x, gy = b * y, g = 1.0 + gx * gx + gy * gy;
      // Upward normals: a bowl (a, b > 0) is concave.
      const double mean = -((1 + gy * gy) * a + (1 + gx * gx) * b) / (2.0 * std::pow(g, 1.5));
      const double gauss = a * b / (g * g);
      const double half = std::sqrt(std::max(0.0, mean * mean - gauss));
      shape.add({x, y, 0.5 * (a * x * x + b * y * y)}, Vec3(-gx, -gy, 1.0) / std::sqrt(g), mean + half, mean - half);
    }
  }
  for (Index r = 0; r + 1 < side; ++r) {
    for (Index c = 0; c + 1 < side; ++c) {
      const Index p = r * side + c, q = p + 1, u = p + side, v = u + 1;
      // Rows are shifted by half a step in turn; the short diagonal changes sides with them.
      if (r % 2 == 0) {
        shape.triangles.push_back({p, q, u});
        shape.triangles.push_back({q, v, u});
      } else {
        shape.triangles.push_back({p, q, v});
        shape.triangles.push_back({p, v, u});
      }
    }
  }
  return shape;
}

inline Shape plane(Index side, double step, double jitter = 0.0) {
  return height_field("plane", side, step, 0, 0, jitter);
}
inline Shape saddle(Index side, double step, double jitter = 0.0) {
  return height_field("saddle", side, step, 1.0, -1.0, jitter);
}

/// Icosahedron, every triangle cut into 4^levels, on a sphere: 10 x 4^levels + 2 vertices. `jitter` in edge lengths.
inline Shape sphere(int levels, double radius, double jitter = 0.0) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  std::vector<Vec3> p = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                         {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Triangle> faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& v : p) v.normalize();
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto middle_of = [&](Index a, Index b) {
      const auto [at, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(p.size()));
      if (fresh) p.push_back((p[a] + p[b]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : faces) {
      const Index a = middle_of(t[0], t[1]), b = middle_of(t[1], t[2]), c = middle_of(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
    }
    faces.swap(finer);
  }
  Shape shape;
  shape.name = "sphere";
  const double edge = (p[faces[0][0]] - p[faces[0][1]]).norm();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 shift(random01(2, 0, i) - 0.5, random01(2, 1, i) - 0.5, random01(2, 2, i) - 0.5);
    const Vec3 n = (p[i] + 2.0 * jitter * edge * shift).normalized();
    shape.add(radius * n, n, 1.0 / radius, 1.0 / radius);
  }
  shape.triangles = std::move(faces);
  return shape;
}

/// Open tube around z.
inline Shape cylinder(Index around, Index along, double radius) {
  Shape shape;
  shape.name = "cylinder";
  const double angle = 2.0 * std::numbers::pi / around;
  for (Index r = 0; r < along; ++r) {
    for (Index c = 0; c < around; ++c) {
      const double t = angle * (c + 0.5 * r);
      const Vec3 n(std::cos(t), std::sin(t), 0.0);
      shape.add(radius * n + Vec3(0, 0, radius * angle * std::sqrt(0.75) * r), n, 1.0 / radius, 0.0);
    }
  }
  for (Index r = 0; r + 1 < along; ++r) {
    for (Index c = 0; c < around; ++c) {
      // Every row is turned by half a step, so the triangles are equilateral up to the bend.
      const Index p = r * around + c, q = r * around + (c + 1) % around;
      const Index u = p + around, w = (r + 1) * around + (c + around - 1) % around;
      shape.triangles.push_back({p, q, u});
      shape.triangles.push_back({p, u, w});
    }
  }
  return shape;
}

/// Ring of radius `major` around z with a tube of radius `minor`.
inline Shape torus(Index around, Index tube, double major, double minor) {
  Shape shape;
  shape.name = "torus";
  for (Index r = 0; r < tube; ++r) {
    for (Index c = 0; c < around; ++c) {
      const double u = 2.0 * std::numbers::pi * c / around, v = 2.0 * std::numbers::pi * r / tube;
      const Vec3 out(std::cos(u), std::sin(u), 0.0);
      const Vec3 n = std::cos(v) * out + Vec3(0, 0, std::sin(v));
      shape.add(major * out + minor * n, n, 1.0 / minor, std::cos(v) / (major + minor * std::cos(v)));
    }
  }
  add_grid_faces(shape, around, tube, true, true);
  return shape;
}

/// The same shape with Gaussian noise of the given standard deviation on every coordinate; normals are kept.
inline Shape with_noise(Shape shape, double sigma, std::uint64_t seed = 7) {
  for (std::size_t i = 0; i < shape.positions.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      shape.positions[i][axis] += sigma * gaussian(seed, static_cast<std::uint64_t>(axis), i);
    }
  }
  return shape;
}

}  // namespace shapelight::testing
