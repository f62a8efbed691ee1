#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/graph/surface_graph.hpp"

namespace shapelight {

/// Parameters of segment_field().
struct SegmentationOptions {
  double scale = 0.5;             ///< [field unit x points] k of tau(C) = k / |C|: larger means larger segments
  int min_points = 20;            ///< [points] smaller segments join a neighbour; 0 with min_share 0: none does
  double min_share = 1.0 / 2000;  ///< [1] the same as a share of all vertices; the larger of the two holds

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"segment-scale", "1", "Preference for large segments, k of tau = k / size.", 0, 1e9}, o.scale);
    visit(OptionInfo{"segment-min-points", "points", "Smaller segments join a neighbour.", 0, 1e9}, o.min_points);
    visit(OptionInfo{"segment-min-share", "1", "Smaller shares of all vertices join a neighbour.", 0, 1}, o.min_share);
  }
};

struct SegmentationResult {
  std::vector<std::uint32_t> label;  ///< n: in [0, count), numbered by the lowest vertex of the segment
  std::size_t count = 0;
};

/// Cuts the surface where a field changes (eq. 9 to 12 of the paper; Felzenszwalb and Huttenlocher).
///
/// Edges with weight |f_i - f_j| are taken in the order (weight, i, j); an edge joins two segments when it is no
/// heavier than min(Int(A) + k / |A|, Int(B) + k / |B|), Int being the heaviest edge of a segment's minimum spanning
/// tree. The result is neither too fine nor too coarse (definitions 1 and 2). Then, in the same order, an edge that
/// touches a segment below max(min_points, min_share n) joins it to the neighbour. Segments without edges out stay as
/// they are. Pre:   field.size() == graph.size(); finite. Post:  every segment is connected; labels canonical, so equal
/// partitions have equal labels. Throws InvalidInput (names option or vertex), Cancelled. Cost:  O(edges): weights in
/// single precision, radix sorted. 16 bytes per edge and 12 n. Support: global.
[[nodiscard]] SegmentationResult segment_field(const SurfaceGraph& graph, std::span<const double> field,
                                               const SegmentationOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
