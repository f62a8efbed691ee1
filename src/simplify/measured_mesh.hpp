#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "simplify/live_mesh.hpp"
#include "simplify/sample_block.hpp"

namespace shapelight::simplification {

/// A point of the input surface, attached to the face of the live mesh that stands for it. One cache line.
struct SurfaceSample {
  Vec3 position;
  float normal[3];          ///< unit normal of its input face; zero when it has no normal term
  float weight = 0.0F;      ///< share of the area
  float turn = 0.0F;        ///< weight of 1 - cos(angle of normals)
  float error = 0.0F;       ///< at its face, weighted
  Index next = kNoIndex;    ///< next sample of the same face
  Index vertex = kNoIndex;  ///< the input vertex that it is, if it is one
};

/// A point of an input line (border, feature edges), attached to a line edge of the live mesh.
struct LineSample {
  Vec3 position;
  double weight = 0.0;
  double error = 0.0;  ///< weighted squared distance from its edge
  Index next = kNoIndex;
};

struct SampleScheme {
  double normal_weight = 0.1;    ///< lambda
  double boundary_weight = 1.0;  ///< of line samples
};

/// A live mesh that knows how well it stands for the input: its energy is the weighted squared distance, and turn of
/// normals, from samples of the input surface and lines. Lengths are in units of the output's edge length.
class MeasuredMesh {
 public:
  /// Samples `target` (the input surface, same vertices as `input`, perhaps denoised) and attaches the samples to
  /// `coarse`, which `input` was collapsed to; its sources are vertices of `input`.
  MeasuredMesh(const ManifoldMesh& input, std::span<const Vec3> target, ManifoldMesh&& coarse,
               const SampleScheme& scheme, const RunContext& context);

  LiveMesh mesh;
  std::vector<std::uint8_t> changed;  ///< per face: its corners or samples have changed since flips last looked

  /// The samples of these faces relative to `origin`; returns their energy. `ids` gets their numbers.
  double gather(std::span<const Index> faces, const Vec3& origin, SampleBlock& block, std::vector<Index>& ids) const;
  /// Gives the faces the samples that gather() found: faces[block.best[i]] gets ids[i]. Safe for disjoint faces at
  /// once.
  void assign(std::span<const Index> faces, const SampleBlock& block, std::span<const Index> ids);

  /// Calls visit(sample) for every sample of the face.
  template <class Visit>
  void for_samples(Index face, Visit&& visit) const {
    for (Index s = first_sample_[face]; s != kNoIndex; s = samples_[s].next) visit(samples_[s]);
  }
  template <class Visit>
  void for_line_samples(Index edge, Visit&& visit) const {
    for (Index s = first_line_sample_[edge]; s != kNoIndex; s = line_samples_[s].next) visit(line_samples_[s]);
  }
  [[nodiscard]] double line_energy(Index edge) const;
  /// Hands all samples of two line edges to whichever of the segments is nearer: the first gets those of (a, b).
  void assign_line(Index first, Index second);
  /// All samples of line edge `gone` go to `kept`, whose ends have changed.
  void merge_line(Index gone, Index kept);

  /// Does a face whose corners come from input vertices a, b, c look the way the input does there? Always true where
  /// the normals there disagree: across creases.
  [[nodiscard]] bool agrees_with_input(const Vec3& normal, Index a, Index b, Index c) const;

 private:
  void sample_lines(const ManifoldMesh& input, std::span<const Vec3> target, const SampleScheme& scheme);

  std::vector<Vec3> input_normal_;  ///< per input vertex
  std::vector<SurfaceSample> samples_;
  std::vector<Index> first_sample_;  ///< per face
  std::vector<LineSample> line_samples_;
  std::vector<Index> first_line_sample_;  ///< per line edge
};

[[nodiscard]] double segment_distance_sq(const Vec3& p, const Vec3& a, const Vec3& b);

}  // namespace shapelight::simplification
