#pragma once

#include <limits>
#include <span>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/spatial/triangle_tree.hpp"
#include "simplify/measured_mesh.hpp"
#include "simplify/star_shape.hpp"

namespace shapelight::simplification {

/// Quadratic model of the energy around one vertex, over its displacement x: x'Ax - 2 g'x.
struct FitModel {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Vec3 g = Vec3::Zero();
  double weight = 0.0;  ///< of the samples of the star
  [[nodiscard]] double change(const Vec3& x) const { return x.dot(A * x) - 2.0 * g.dot(x); }
};

/// The model of vertex v at its place: point-to-plane with a small tangential weight, normals, lines (least squares
/// over the samples of its star, each held at its closest point).
[[nodiscard]] FitModel fit_model(const MeasuredMesh& measured, Index v, double normal_weight);

/// The star of a vertex with the vertex somewhere else, and the samples that belong to it.
class StarTrial {
 public:
  /// Gathers the samples of the star.
  void begin(const MeasuredMesh& measured, Index v);
  /// Energy with the vertex at `place`, lines included; infinity where a face would turn or degenerate.
  /// `source`: the input vertex at that place, if there is one.
  double energy_at(const Vec3& place, Index source = kNoIndex);
  /// Energy where the vertex is now.
  [[nodiscard]] double energy_now() const { return energy_now_; }
  /// Moves the vertex to the place that energy_at() was last asked about.
  void accept(MeasuredMesh& measured) const;
  /// Moves v to `place` whatever it costs; not when no face there would have an area.
  [[nodiscard]] bool force(MeasuredMesh& measured, Index v, const Vec3& place);

 private:
  double line_energy_at(const Vec3& place) const;

  const MeasuredMesh* measured_ = nullptr;
  Index v_ = kNoIndex;
  double energy_now_ = 0.0;
  Vec3 place_ = Vec3::Zero();
  StarShape shape_;
  SampleBlock block_;
  std::vector<Index> ids_;
};

/// The input surface, to keep fitted vertices near it: without it they spike out where no sample pulls them back.
class InputSurface {
 public:
  InputSurface(const TriangleMesh& surface, std::size_t num_vertices, const RunContext& context)
      : tree_(surface, context), last_(num_vertices), surface_(surface) {}
  /// Closest point to `p`, a place for vertex v. Safe for different vertices at once.
  [[nodiscard]] const TriangleTree::Hit& closest(const Vec3& p, Index v);
  /// Area times mean squared distance from the input of the faces that removing u into v would leave.
  [[nodiscard]] double error_of_removal(const LiveMesh& mesh, Index u, Index v) const;
  [[nodiscard]] Vec3 normal(Index face) const;

 private:
  TriangleTree tree_;
  struct Search {
    Vec3 from = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    TriangleTree::Hit hit;
  };
  std::vector<Search> last_;  ///< per vertex: a start for the next one, and often its answer
  const TriangleMesh& surface_;
};

/// Puts vertices of one class that have moved at once back to the places `before` where that has folded faces; a move
/// alone cannot tell, for the far vertex of a face outside may move too. Returns which ones, by their place in
/// `vertices`.
std::vector<std::size_t> put_folded_back(MeasuredMesh& measured, std::span<const Index> vertices,
                                         std::span<const Vec3> before, const RunContext& context);

/// Moves each of these vertices to where its samples want it, class by class. Locked ones stay.
void fit_vertices(MeasuredMesh& measured, std::span<const Index> vertices, double normal_weight, InputSurface& input,
                  const RunContext& context);

}  // namespace shapelight::simplification
