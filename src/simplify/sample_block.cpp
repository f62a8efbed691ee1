#include "simplify/sample_block.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vectorize.hpp"

namespace shapelight::simplification {
namespace {

constexpr std::size_t kLanes = 8;

// The triangle in floats, relative to its first corner. Edge k: signed distance m.p - m0, coordinate along it d.p - d0.
struct PackedTriangle {
  explicit PackedTriangle(const LocalTriangle& t) {
    float corner[3][3];
    for (int j = 0; j < 3; ++j) {
      origin[j] = static_cast<float>(t.corner[0][j]);
      n[j] = static_cast<float>(t.normal[j]);
      for (int k = 0; k < 3; ++k) corner[k][j] = static_cast<float>(t.corner[k][j] - t.corner[0][j]);
    }
    for (int k = 0; k < 3; ++k) {
      const float* from = corner[k];
      const float* to = corner[(k + 1) % 3];
      const float e[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
      length[k] = std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
      const float inverse = length[k] > 0.0F ? 1.0F / length[k] : 0.0F;
      for (int j = 0; j < 3; ++j) d[k][j] = e[j] * inverse;
      for (int j = 0; j < 3; ++j) m[k][j] = d[k][(j + 1) % 3] * n[(j + 2) % 3] - d[k][(j + 2) % 3] * n[(j + 1) % 3];
      m0[k] = m[k][0] * from[0] + m[k][1] * from[1] + m[k][2] * from[2];
      d0[k] = d[k][0] * from[0] + d[k][1] * from[1] + d[k][2] * from[2];
    }
  }
  float origin[3], n[3], m[3][3], d[3][3], m0[3], d0[3], length[3];
};

// Squared distance from the line segment of edge k, within the plane; `side` gets the signed distance from its line.
inline float edge_distance_sq(const PackedTriangle& t, int k, float x, float y, float z, float& side) {
  side = t.m[k][0] * x + t.m[k][1] * y + t.m[k][2] * z - t.m0[k];
  const float along = t.d[k][0] * x + t.d[k][1] * y + t.d[k][2] * z - t.d0[k];
  const float clamped = std::min(std::max(along, 0.0F), t.length[k]);
  const float beyond = along - clamped;
  return side * side + beyond * beyond;
}

SHAPELIGHT_VECTORIZE void offer_packed(const PackedTriangle& triangle, std::int32_t id, std::size_t count,
                                       const float* __restrict x, const float* __restrict y, const float* __restrict z,
                                       const float* __restrict nx, const float* __restrict ny,
                                       const float* __restrict nz, const float* __restrict weight,
                                       const float* __restrict turn, float* __restrict error,
                                       std::int32_t* __restrict best) {
  const PackedTriangle t = triangle;  // a copy that nothing written below can alias
  for (std::size_t i = 0; i < count; ++i) {
    const float px = x[i] - t.origin[0];
    const float py = y[i] - t.origin[1];
    const float pz = z[i] - t.origin[2];
    float s0, s1, s2;
    const float q0 = edge_distance_sq(t, 0, px, py, pz, s0);
    const float q1 = edge_distance_sq(t, 1, px, py, pz, s1);
    const float q2 = edge_distance_sq(t, 2, px, py, pz, s2);
    const float nearest_edge = std::min(std::min(q0, q1), q2);
    const float farthest_out = std::max(std::max(s0, s1), s2);
    const float in_plane = farthest_out > 0.0F ? nearest_edge : 0.0F;
    const float height = t.n[0] * px + t.n[1] * py + t.n[2] * pz;
    const float dx = nx[i] - t.n[0];
    const float dy = ny[i] - t.n[1];
    const float dz = nz[i] - t.n[2];
    const float turned = 0.5F * (dx * dx + dy * dy + dz * dz);  // 1 - cosine, exact for small angles too
    const float e = weight[i] * (height * height + in_plane) + turn[i] * turned;
    const bool better = e < error[i];
    error[i] = better ? e : error[i];
    best[i] = better ? id : best[i];
  }
}

}  // namespace

LocalTriangle::LocalTriangle(const Vec3& a, const Vec3& b, const Vec3& c) : corner{a, b, c} {
  const Vec3 u = b - a, v = c - a;
  const Vec3 cross = u.cross(v);
  double_area = cross.norm();
  longest_sq = std::max({u.squaredNorm(), v.squaredNorm(), (c - b).squaredNorm()});
  normal = double_area > 0.0 ? Vec3(cross / double_area) : Vec3::Zero();
}

void SampleBlock::resize(std::size_t count) {
  size_ = count;
  const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
  for (auto* column : {&x, &y, &z, &nx, &ny, &nz, &weight, &turn, &error}) {
    column->resize(padded);
    std::fill(column->begin() + static_cast<std::ptrdiff_t>(count), column->end(), 0.0F);
  }
  best.resize(padded);
}

void SampleBlock::reset() {
  std::fill(error.begin(), error.end(), std::numeric_limits<float>::infinity());
  std::fill(best.begin(), best.end(), -1);
}

void SampleBlock::offer(const LocalTriangle& triangle, std::int32_t id) {
  if (triangle.double_area <= 0.0) return;  // no plane to measure against
  offer_packed(PackedTriangle(triangle), id, error.size(), x.data(), y.data(), z.data(), nx.data(), ny.data(),
               nz.data(), weight.data(), turn.data(), error.data(), best.data());
}

double SampleBlock::total() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < size_; ++i) sum += error[i];
  return sum;
}

}  // namespace shapelight::simplification
