#include "denoise/patch.hpp"

#include <cmath>

#include "core/parallel.hpp"
#include "core/tangent_frame.hpp"
#include "graph/ring_chunk.hpp"

namespace shapelight {
namespace {

using Eigen::Array4f;

constexpr std::size_t kMostPoints = 64;  // of a 2-ring: 19 on a regular mesh, about 45 among 12 nearest neighbours

// Square roots of the Gaussian weights, one cell wide, of a net whose nodes lie at -1.5, -0.5, 0.5, 1.5 cells from the
// centre. exp(-x^2 / 2) is separable, so one vector describes both directions; its squares sum to 1.
Array4f root_weights() {
  const Array4f offset(-1.5f, -0.5f, 0.5f, 1.5f);
  const Array4f weight = (offset.square() * -0.5f).exp();
  return (weight / weight.sum()).sqrt();
}

// The four uniform cubic B-splines on one cell, u in [0, 1].
Array4f basis(float u) {
  const float v = 1.0f - u, u2 = u * u, u3 = u2 * u;
  return Array4f(v * v * v, 3.0f * u3 - 6.0f * u2 + 4.0f, -3.0f * u3 + 3.0f * u2 + 3.0f * u + 1.0f, u3) / 6.0f;
}

struct PlanePoint {
  float x, y, z;  // projected place, field
};

TangentFrame patch_frame(const Vec3& normal, const Vec3& direction1) {
  if (direction1.isZero(0.0))
    return normal.isZero(0.0) ? TangentFrame{Vec3::UnitX(), Vec3::UnitY()} : tangent_frame(normal);
  return {direction1, normal.cross(direction1)};
}

// One level of Lee, Wolberg and Shin: every point c asks node (k, l) for w z / sum w^2 with w = B_k(x) B_l(y); a node
// takes the mean of what it is asked, with weights w^2. Both sums are separable in k and l.
void approximate(std::span<const PlanePoint> points, float mean, float radius, PatchNet& net) {
  std::array<Array4f, 4> asked, weight;
  asked.fill(Array4f::Zero());
  weight.fill(Array4f::Zero());
  const float scale = radius > 0.0f ? 0.5f / radius : 0.0f;
  for (const PlanePoint& p : points) {
    const Array4f bx = basis(0.5f + scale * p.x), by = basis(0.5f + scale * p.y);
    const Array4f bx2 = bx.square(), by2 = by.square();
    const Array4f wanted = by2 * by * ((p.z - mean) / (bx2.sum() * by2.sum()));
    for (int k = 0; k < 4; ++k) {
      asked[static_cast<std::size_t>(k)] += bx2[k] * bx[k] * wanted;
      weight[static_cast<std::size_t>(k)] += bx2[k] * by2;
    }
  }
  static const Array4f roots = root_weights();
  for (std::size_t k = 0; k < 4; ++k) {
    // A node whose basis vanishes at all points has asked = weight = 0 and takes the mean.
    const Array4f node = mean + asked[k] / weight[k].max(1e-20f);
    Eigen::Map<Array4f>(&net.value[4 * k]) = node * roots * roots[static_cast<int>(k)];
  }
}

}  // namespace

PatchNets build_patch_nets(const SurfaceGraph& graph, std::span<const double> field, std::span<const Vec3> direction1,
                           const RunContext& context) {
  PatchNets nets{std::vector<PatchNet>(graph.size()), std::vector<float>(graph.size())};
  const Array4f roots = root_weights();
  parallel::for_chunks(
      context, graph.size(),
      [&](std::size_t begin, std::size_t end) {
        RingCollector rings(graph);
        std::vector<PlanePoint> points;
        for (std::size_t i = begin; i < end; ++i) {
          const TangentFrame frame = patch_frame(graph.normal[i], direction1[i]);
          points.clear();
          float sum = 0.0f, radius_sq = 0.0f;
          for (const Index j : rings.collect(static_cast<Index>(i), 2, kMostPoints)) {
            const Vec3 d = graph.position[j] - graph.position[i];
            const PlanePoint p{static_cast<float>(d.dot(frame.x)), static_cast<float>(d.dot(frame.y)),
                               static_cast<float>(field[j])};
            sum += p.z;
            radius_sq = std::max(radius_sq, p.x * p.x + p.y * p.y);
            points.push_back(p);
          }
          approximate(points, sum / static_cast<float>(points.size()), std::sqrt(radius_sq), nets.net[i]);
          float mean = 0.0f;
          for (std::size_t m = 0; m < 16; ++m)
            mean += nets.net[i].value[m] * roots[static_cast<int>(m / 4)] * roots[static_cast<int>(m % 4)];
          nets.mean[i] = mean;
        }
      },
      ring_chunk(graph));
  return nets;
}

TurnedNet turned_net(const PatchNet& net) {
  TurnedNet turned;
  PatchNet current = net;
  for (int r = 0; r < 4; ++r) {
    PatchNet next;
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t l = 0; l < 4; ++l) {
        turned[4 * k + l][r] = current.value[4 * k + l];
        next.value[4 * k + l] = current.value[4 * l + (3 - k)];
      }
    }
    current = next;
  }
  return turned;
}

}  // namespace shapelight
