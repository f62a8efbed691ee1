#include "shapelight/simplify/ssim.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/poll.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/data/geometry.hpp"
#include "simplify/measured_collapse.hpp"
#include "simplify/measured_flips.hpp"
#include "simplify/morton_order.hpp"
#include "simplify/quadric_collapse.hpp"
#include "simplify/vertex_fit.hpp"
#include "simplify/vertex_moves.hpp"

namespace shapelight {
namespace {

using namespace simplification;

constexpr int kMaxFlipPasses = 6;
constexpr double kQuadricBoundary =
    3.0;                                 // of planes on lines: they hold borders that only the measured error can judge
constexpr double kAreaPerVertex = 1.15;  // of an even triangulation, in squared edge lengths: 2 / sqrt(3)

double total_area(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const auto& p = mesh.positions;
    area += 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm();
  }
  return area;
}

// Units in which the output's edges are about 1 long, about the middle of the input.
struct WorkFrame {
  Vec3 center;
  double unit;
  [[nodiscard]] Vec3 to(const Vec3& p) const { return (p - center) / unit; }
  [[nodiscard]] Vec3 from(const Vec3& p) const { return unit * p + center; }
};

// A counting sort, stable.
void sort_by_first_vertex(std::vector<Triangle>& triangles, std::size_t num_vertices, const RunContext& context) {
  const auto first = [](const Triangle& t) { return std::min({t[0], t[1], t[2]}); };
  std::vector<std::size_t> next(num_vertices + 1, 0);
  for (const Triangle& t : triangles) ++next[first(t) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Triangle> sorted(triangles.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    poll(context, f);
    sorted[next[first(triangles[f])]++] = triangles[f];
  }
  triangles.swap(sorted);
}

// The mesh with its vertices, and faces by their first vertex, along a Morton curve: what is near is near in memory.
ManifoldMesh along_morton_curve(const ManifoldMesh& mesh, const RunContext& context) {
  const BoundingBox box = bounding_box(mesh.mesh.positions);
  const double side = (box.max - box.min).maxCoeff();
  const std::vector<Index> order = morton_order(mesh.mesh.positions, box.min, side > 0.0 ? 1.0 / side : 0.0, context);
  std::vector<Index> place(order.size());
  ManifoldMesh sorted;
  for (Index i = 0; i < order.size(); ++i) {
    poll(context, i);
    const Index v = order[i];
    place[v] = i;
    sorted.mesh.positions.push_back(mesh.mesh.positions[v]);
    sorted.source.push_back(mesh.source[v]);
    sorted.locked.push_back(mesh.locked[v]);
    if (!mesh.junction.empty()) sorted.junction.push_back(mesh.junction[v]);
    sorted.line.push_back(mesh.line[v]);
  }
  const auto renumber = [&](Index& v) { v = v == kNoIndex ? kNoIndex : place[v]; };
  for (std::array<Index, 2>& ends : sorted.line) std::for_each(ends.begin(), ends.end(), renumber);
  context.check();
  sorted.mesh.triangles = mesh.mesh.triangles;
  for (Triangle& t : sorted.mesh.triangles) std::for_each(t.begin(), t.end(), renumber);
  sort_by_first_vertex(sorted.mesh.triangles, order.size(), context);
  return sorted;
}

// The work of one run of SSim: the input, made manifold, in the work frame; its vertices number everything.
class Ssim {
 public:
  /// `target` counts the vertices of `manifold`, which was made of `mesh`.
  Ssim(const TriangleMesh& mesh, const ManifoldMesh& manifold, const SimplifyTarget& target, const SsimGuide& guide,
       const SsimOptions& options, const RunContext& context)
      : mesh_(mesh),
        guide_(guide),
        options_(options),
        context_(context),
        input_(along_morton_curve(manifold, context)),
        input_source_(input_.source),
        target_(target) {
    context.check();
    std::iota(input_.source.begin(), input_.source.end(), Index{0});
    const double area = total_area(input_.mesh);
    const double vertices = static_cast<double>(target.vertices > 0 ? target.vertices : target.faces / 2 + 1);
    frame_ = {bounding_box(input_.mesh.positions).center(), std::sqrt(kAreaPerVertex * area / vertices)};
    if (!(frame_.unit > 0.0)) throw InvalidInput("simplify: the mesh has no area");
    for (Vec3& p : input_.mesh.positions) p = frame_.to(p);
    if (!guide.denoised.empty()) {
      for (const Index v : input_source_) denoised_.push_back(frame_.to(guide.denoised[v]));
    }
  }

  SimplifiedMesh run() {
    const std::vector<float> removal_weight = removal_weights();
    ManifoldMesh coarse = pre_collapse(removal_weight);
    const SampleScheme scheme{.normal_weight = options_.normal_weight, .boundary_weight = options_.boundary_weight};
    MeasuredMesh measured(input_, surface(), std::move(coarse), scheme, context_.phase(0.2, 0.3, "attach samples"));
    std::optional<InputSurface> original;
    TriangleMesh original_mesh;
    if (options_.placement == Placement::Optimal) {
      original_mesh = {{surface().begin(), surface().end()}, input_.mesh.triangles};
      original.emplace(original_mesh, measured.mesh.num_vertices(), context_);
    }
    collapse(measured, original, removal_weight);
    refine(measured, original);
    return finish(std::move(measured.mesh).compact());
  }

 private:
  [[nodiscard]] std::span<const Vec3> surface() const {
    return denoised_.empty() ? std::span<const Vec3>(input_.mesh.positions) : std::span<const Vec3>(denoised_);
  }

  std::vector<float> removal_weights() const {
    if (guide_.samples.empty() || options_.sample_weight == 1.0) return {};
    std::vector<std::uint8_t> is_sample(mesh_.positions.size(), 0);
    for (const Index v : guide_.samples) is_sample[v] = 1;
    std::vector<float> weight(input_.source.size());
    for (std::size_t v = 0; v < weight.size(); ++v) {
      weight[v] = is_sample[input_source_[v]] ? static_cast<float>(options_.sample_weight) : 1.0F;
    }
    return weight;
  }

  ManifoldMesh pre_collapse(std::span<const float> removal_weight) {
    const auto times = [&](std::size_t count) {
      return static_cast<std::size_t>(options_.pre_collapse * static_cast<double>(count));
    };
    SimplifyTarget coarse = target_;
    if (options_.pre_collapse > 1.0) coarse = {times(target_.vertices), times(target_.faces)};
    const bool is_needed = coarse.vertices > 0 ? coarse.vertices < input_.mesh.positions.size()
                                               : coarse.faces < input_.mesh.triangles.size();
    if (!is_needed) return input_;
    context_.check();
    ManifoldMesh surface_mesh = input_;  // quadrics would follow the noise
    surface_mesh.mesh.positions.assign(surface().begin(), surface().end());
    ManifoldMesh collapsed = collapse_quadrics(std::move(surface_mesh), coarse,
                                               {.placement = options_.placement,
                                                .boundary_weight = kQuadricBoundary * options_.boundary_weight,
                                                .removal_weight = removal_weight,
                                                .must_reach = options_.pre_collapse == 1.0},
                                               context_.phase(0.05, 0.2, "collapse by quadrics"));
    if (options_.placement == Placement::Input) {
      for (std::size_t v = 0; v < collapsed.source.size(); ++v) {
        collapsed.mesh.positions[v] = input_.mesh.positions[collapsed.source[v]];
      }
    }
    return collapsed;
  }

  void collapse(MeasuredMesh& measured, std::optional<InputSurface>& original, std::span<const float> removal_weight) {
    const RunContext context = context_.phase(0.3, 0.6, "collapse by measured error");
    MeasuredCollapse how{.removal_weight = removal_weight};
    if (original) {
      how.fit = [&](std::span<const Index> vertices) {
        fit_vertices(measured, vertices, options_.normal_weight, *original, context_);
      };
      how.backward = [&](Index u, Index v) { return original->error_of_removal(measured.mesh, u, v); };
    }
    const LiveMesh& mesh = measured.mesh;
    // A removal takes one vertex, and two faces or, on borders, one: faces are reached in a few steps.
    while (true) {
      const std::size_t left = target_.vertices > 0
                                   ? mesh.num_live_vertices() - std::min(mesh.num_live_vertices(), target_.vertices)
                                   : (mesh.num_live_faces() - std::min(mesh.num_live_faces(), target_.faces) + 1) / 2;
      if (left == 0) break;
      if (!collapse_measured(measured, left, how, context)) {
        throw TargetUnreachable(fmt::format("the topology of the mesh allows no fewer than {} vertices ({} faces)",
                                            mesh.num_live_vertices(), mesh.num_live_faces()),
                                target_.vertices > 0 ? mesh.num_live_vertices() : mesh.num_live_faces());
      }
    }
  }

  void refine(MeasuredMesh& measured, std::optional<InputSurface>& original) {
    const RunContext context = context_.phase(0.6, 1.0, "flip and move");
    context.check();
    const std::size_t enough = measured.mesh.num_live_vertices() / 200;
    for (int pass = 0; pass < kMaxFlipPasses; ++pass) {
      if (flip_edges(measured, context) <= enough) break;
    }
    InputPlaces places;
    if (!original) {
      places = {input_.mesh.positions, input_.line, input_.locked, std::vector<std::uint8_t>(input_.source.size(), 0)};
      for (Index v = 0; v < measured.mesh.num_vertices(); ++v) {
        if (measured.mesh.is_alive(v)) places.taken[measured.mesh.source[v]] = 1;
      }
    }
    std::vector<Index> alive;
    for (Index v = 0; v < measured.mesh.num_vertices(); ++v) {
      if (measured.mesh.is_alive(v)) alive.push_back(v);
    }
    for (std::uint32_t sweep = 0; sweep < options_.sweeps; ++sweep) {
      context.report(static_cast<double>(sweep) / options_.sweeps);
      if (original) {
        fit_vertices(measured, alive, options_.normal_weight, *original, context_);
      } else {
        move_vertices(measured, places, options_.normal_weight, context_);
      }
      flip_edges(measured, context_);
    }
  }

  SimplifiedMesh finish(ManifoldMesh&& result) const {
    for (std::size_t v = 0; v < result.source.size(); ++v) {
      Vec3& p = result.mesh.positions[v];
      const bool stayed = p == input_.mesh.positions[result.source[v]];
      result.source[v] = input_source_[result.source[v]];
      p = stayed ? mesh_.positions[result.source[v]] : frame_.from(p);  // to the bit where nothing has moved
    }
    return merge_copies(std::move(result));
  }

  const TriangleMesh& mesh_;
  const SsimGuide& guide_;
  const SsimOptions& options_;
  const RunContext& context_;
  ManifoldMesh input_;               // sources number its own vertices
  std::vector<Index> input_source_;  // per vertex of input_: vertex of mesh_
  std::vector<Vec3> denoised_;
  SimplifyTarget target_;
  WorkFrame frame_{};
};

void check_guide(const SsimGuide& guide, std::size_t num_vertices) {
  for (const Index v : guide.samples) {
    if (v >= num_vertices) throw InvalidInput(fmt::format("ssim: sample {} >= {} vertices", v, num_vertices));
  }
  if (!guide.denoised.empty() && guide.denoised.size() != num_vertices) {
    throw InvalidInput(fmt::format("ssim: {} denoised positions, expected one for each of {} vertices",
                                   guide.denoised.size(), num_vertices));
  }
}

}  // namespace

SimplifiedMesh simplify_ssim(const TriangleMesh& mesh, const SimplifyTarget& target, const SsimGuide& guide,
                             const SsimOptions& options, const FeatureEdges& features, const RunContext& context,
                             MeshOddities* oddities) {
  validate_options(options);
  if ((target.vertices == 0) == (target.faces == 0)) {
    throw InvalidInput("simplify: expected a target of either vertices or faces");
  }
  check_guide(guide, mesh.positions.size());
  ManifoldMesh manifold = make_manifold(mesh, features, context.phase(0.0, 0.05, "prepare"), oddities);
  SimplifyTarget copies = target;  // locked copies of one vertex count one by one, and are merged in the end
  if (target.vertices > 0) copies.vertices += manifold.source.size() - num_merged_vertices(manifold);
  const bool is_reached = target.vertices > 0 ? manifold.mesh.positions.size() <= copies.vertices
                                              : manifold.mesh.triangles.size() <= copies.faces;
  SimplifiedMesh result =
      is_reached ? merge_copies(std::move(manifold)) : Ssim(mesh, manifold, copies, guide, options, context).run();
  context.check();
  context.report(1.0, "done");
  return result;
}

}  // namespace shapelight
