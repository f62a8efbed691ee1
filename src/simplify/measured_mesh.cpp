#include "simplify/measured_mesh.hpp"

#include <algorithm>
#include <utility>

#include "core/parallel.hpp"
#include "core/poll.hpp"
#include "shapelight/spatial/triangle_tree.hpp"

namespace shapelight::simplification {
namespace {

constexpr double kLineShare = 0.15;    // weight of a line sample per length, in units of the output's edge length
constexpr double kCreaseLength = 2.4;  // of the sum of three unit normals: less, and they stand across a crease
constexpr double kMinAgreement = 0.5;  // cosine

std::vector<Vec3> vertex_normals(std::span<const Vec3> position, std::span<const Triangle> triangles,
                                 const RunContext& context) {
  std::vector<Vec3> normal(position.size(), Vec3::Zero());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    poll(context, f);
    const Triangle& t = triangles[f];
    const Vec3 cross = (position[t[1]] - position[t[0]]).cross(position[t[2]] - position[t[0]]);
    for (const Index v : t) normal[v] += cross;
  }
  context.check();
  for (Vec3& n : normal) n.normalize();
  return normal;
}

SurfaceSample sample_at(const Vec3& position, double weight) {
  SurfaceSample s;
  s.position = position;
  s.normal[0] = s.normal[1] = s.normal[2] = 0.0F;
  s.weight = static_cast<float>(weight);
  return s;
}

// Shares of the area (METHOD, part S). Centroids alone carry normals: those of vertices would blur creases. Midpoints
// of edges add nothing that was measurable, at twice the samples.
constexpr double kCentroidShare = 0.75;
constexpr double kVertexShare = 0.25;

struct SampledSurface {
  std::vector<SurfaceSample> samples;
  std::vector<Index> face;  // per sample: a face of the input that it lies on
};

SampledSurface sample_surface(std::span<const Vec3> position, std::span<const Triangle> triangles, double normal_weight,
                              const RunContext& context) {
  SampledSurface out;
  out.samples.reserve(triangles.size() + position.size());
  out.face.reserve(triangles.size() + position.size());
  std::vector<double> vertex_area(position.size(), 0.0);
  std::vector<Index> vertex_face(position.size(), kNoIndex);
  for (Index f = 0; f < triangles.size(); ++f) {
    poll(context, f);
    const Triangle& t = triangles[f];
    const Vec3 cross = (position[t[1]] - position[t[0]]).cross(position[t[2]] - position[t[0]]);
    const double double_area = cross.norm();
    const double area = 0.5 * double_area;
    SurfaceSample s = sample_at((position[t[0]] + position[t[1]] + position[t[2]]) / 3.0, kCentroidShare * area);
    if (double_area > 0.0) {
      for (int j = 0; j < 3; ++j) s.normal[j] = static_cast<float>(cross[j] / double_area);
      s.turn = static_cast<float>(2.0 * normal_weight * normal_weight * s.weight);
    }
    out.samples.push_back(s);
    out.face.push_back(f);
    for (const Index v : t) {
      vertex_area[v] += area / 3.0;
      vertex_face[v] = f;
    }
  }
  for (Index v = 0; v < position.size(); ++v) {
    poll(context, v);
    out.samples.push_back(sample_at(position[v], kVertexShare * vertex_area[v]));
    out.samples.back().vertex = v;
    out.face.push_back(vertex_face[v]);
  }
  return out;
}

// The closest face of `mesh` for every sample.
std::vector<Index> closest_faces(const LiveMesh& mesh, std::span<const SurfaceSample> samples,
                                 const RunContext& context) {
  TriangleMesh live{mesh.position, {}};
  live.triangles.reserve(mesh.num_faces());
  context.check();
  for (Index f = 0; f < mesh.num_faces(); ++f) live.triangles.push_back(mesh.face(f));
  const TriangleTree tree(live, context);
  std::vector<Index> face(samples.size());
  parallel::for_chunks(context, samples.size(), [&](std::size_t begin, std::size_t end) {
    Index hint = kNoIndex;
    for (std::size_t i = begin; i < end; ++i) hint = face[i] = tree.closest(samples[i].position, hint).triangle;
  });
  return face;
}

// Orders samples by face, so that those of one face lie side by side in memory.
void sort_by_face(std::vector<SurfaceSample>& samples, std::vector<Index>& face, std::size_t num_faces,
                  const RunContext& context) {
  std::vector<std::size_t> begin(num_faces + 1, 0);
  for (const Index f : face) ++begin[f + 1];
  for (std::size_t f = 0; f < num_faces; ++f) begin[f + 1] += begin[f];
  std::vector<SurfaceSample> sorted(samples.size());
  std::vector<Index> sorted_face(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    poll(context, i);
    const std::size_t to = begin[face[i]]++;
    sorted[to] = samples[i];
    sorted_face[to] = face[i];
  }
  samples.swap(sorted);
  face.swap(sorted_face);
}

LocalTriangle local_triangle(const LiveMesh& mesh, Index f, const Vec3& origin) {
  const Triangle& t = mesh.face(f);
  return {mesh.position[t[0]] - origin, mesh.position[t[1]] - origin, mesh.position[t[2]] - origin};
}

}  // namespace

double segment_distance_sq(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length_sq = along.squaredNorm();
  const double t = length_sq > 0.0 ? std::clamp((p - a).dot(along) / length_sq, 0.0, 1.0) : 0.0;
  return (a + t * along - p).squaredNorm();
}

MeasuredMesh::MeasuredMesh(const ManifoldMesh& input, std::span<const Vec3> target, ManifoldMesh&& coarse,
                           const SampleScheme& scheme, const RunContext& context)
    : mesh(std::move(coarse)), changed(mesh.num_faces(), 1), first_sample_(mesh.num_faces(), kNoIndex) {
  SampledSurface surface = sample_surface(target, input.mesh.triangles, scheme.normal_weight, context);
  samples_ = std::move(surface.samples);
  const bool is_whole = mesh.num_vertices() == input.mesh.positions.size();
  std::vector<Index> face = is_whole ? std::move(surface.face) : closest_faces(mesh, samples_, context);
  sort_by_face(samples_, face, mesh.num_faces(), context);
  for (std::size_t s = samples_.size(); s-- > 0;) {
    poll(context, s);
    samples_[s].next = std::exchange(first_sample_[face[s]], static_cast<Index>(s));
  }
  parallel::for_chunks(context, mesh.num_faces(), [&](std::size_t begin, std::size_t end) {
    SampleBlock block;
    std::vector<Index> ids;
    for (std::size_t f = begin; f < end; ++f) {
      const Index faces[1] = {static_cast<Index>(f)};
      const Vec3& origin = mesh.position[mesh.face(faces[0])[0]];
      gather(faces, origin, block, ids);
      block.reset();
      block.offer(local_triangle(mesh, faces[0], origin), 0);
      for (std::size_t i = 0; i < ids.size(); ++i) samples_[ids[i]].error = block.best[i] < 0 ? 0.0F : block.error[i];
    }
  });
  context.check();
  sample_lines(input, target, scheme);
  input_normal_ = vertex_normals(target, input.mesh.triangles, context);
}

void MeasuredMesh::sample_lines(const ManifoldMesh& input, std::span<const Vec3> target, const SampleScheme& scheme) {
  first_line_sample_.assign(mesh.num_line_edges(), kNoIndex);
  std::vector<std::uint8_t> survives(input.source.size(), 0);
  for (const Index v : mesh.source) survives[v] = 1;
  // The input line from the source of `from` on, in the direction of its i-th neighbour, to the next survivor.
  const auto walk = [&](Index from, int i, std::vector<Index>& chain) {
    chain = {from, input.line[from][i]};
    while (!survives[chain.back()]) {
      const std::array<Index, 2>& next = input.line[chain.back()];
      chain.push_back(next[0] == chain[chain.size() - 2] ? next[1] : next[0]);
    }
  };
  std::vector<Index> chain;
  for (Index e = 0; e < mesh.num_line_edges(); ++e) {
    auto [p, q] = mesh.line_ends(e);
    if (input.line[mesh.source[p]][0] == kNoIndex) std::swap(p, q);
    walk(mesh.source[p], 0, chain);
    if (chain.back() != mesh.source[q]) walk(mesh.source[p], 1, chain);
    if (chain.back() != mesh.source[q]) continue;
    for (std::size_t k = 1; k < chain.size(); ++k) {
      const Vec3& a = target[chain[k - 1]];
      const Vec3& b = target[chain[k]];
      for (const double t : {0.25, 0.75}) {
        LineSample s;
        s.position = a + t * (b - a);
        s.weight = scheme.boundary_weight * kLineShare * 0.5 * (b - a).norm();
        s.error = s.weight * segment_distance_sq(s.position, mesh.position[p], mesh.position[q]);
        s.next = std::exchange(first_line_sample_[e], static_cast<Index>(line_samples_.size()));
        line_samples_.push_back(s);
      }
    }
  }
}

double MeasuredMesh::gather(std::span<const Index> faces, const Vec3& origin, SampleBlock& block,
                            std::vector<Index>& ids) const {
  ids.clear();
  for (const Index f : faces) {
    for (Index s = first_sample_[f]; s != kNoIndex; s = samples_[s].next) ids.push_back(s);
  }
  block.resize(ids.size());
  double energy = 0.0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const SurfaceSample& s = samples_[ids[i]];
    block.x[i] = static_cast<float>(s.position[0] - origin[0]);
    block.y[i] = static_cast<float>(s.position[1] - origin[1]);
    block.z[i] = static_cast<float>(s.position[2] - origin[2]);
    block.nx[i] = s.normal[0];
    block.ny[i] = s.normal[1];
    block.nz[i] = s.normal[2];
    block.weight[i] = s.weight;
    block.turn[i] = s.turn;
    energy += s.error;
  }
  return energy;
}

void MeasuredMesh::assign(std::span<const Index> faces, const SampleBlock& block, std::span<const Index> ids) {
  for (const Index f : faces) {
    first_sample_[f] = kNoIndex;
    changed[f] = 1;
  }
  for (std::size_t i = ids.size(); i-- > 0;) {
    SurfaceSample& s = samples_[ids[i]];
    s.error = block.error[i];
    s.next = std::exchange(first_sample_[faces[block.best[i]]], ids[i]);
  }
}

double MeasuredMesh::line_energy(Index edge) const {
  double sum = 0.0;
  for_line_samples(edge, [&](const LineSample& s) { sum += s.error; });
  return sum;
}

void MeasuredMesh::assign_line(Index first, Index second) {
  const auto distance_sq = [&](const Vec3& p, Index edge) {
    const auto& [a, b] = mesh.line_ends(edge);
    return segment_distance_sq(p, mesh.position[a], mesh.position[b]);
  };
  Index pending[2] = {std::exchange(first_line_sample_[first], kNoIndex),
                      std::exchange(first_line_sample_[second], kNoIndex)};
  for (Index s : pending) {
    while (s != kNoIndex) {
      LineSample& sample = line_samples_[s];
      const double d0 = distance_sq(sample.position, first);
      const double d1 = distance_sq(sample.position, second);
      sample.error = sample.weight * std::min(d0, d1);
      const Index next = sample.next;
      sample.next = std::exchange(first_line_sample_[d0 <= d1 ? first : second], s);
      s = next;
    }
  }
}

void MeasuredMesh::merge_line(Index gone, Index kept) {
  const auto& [a, b] = mesh.line_ends(kept);
  Index pending[2] = {std::exchange(first_line_sample_[gone], kNoIndex),
                      std::exchange(first_line_sample_[kept], kNoIndex)};
  for (Index s : pending) {
    while (s != kNoIndex) {
      LineSample& sample = line_samples_[s];
      sample.error = sample.weight * segment_distance_sq(sample.position, mesh.position[a], mesh.position[b]);
      s = std::exchange(sample.next, std::exchange(first_line_sample_[kept], s));
    }
  }
}

bool MeasuredMesh::agrees_with_input(const Vec3& normal, Index a, Index b, Index c) const {
  const Vec3 sum = input_normal_[a] + input_normal_[b] + input_normal_[c];
  const double length_sq = sum.squaredNorm();
  if (length_sq < kCreaseLength * kCreaseLength) return true;
  const double along = normal.dot(sum);
  return along > 0.0 && along * along > kMinAgreement * kMinAgreement * length_sq;
}

}  // namespace shapelight::simplification
