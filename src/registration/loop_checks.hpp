#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shapelight/registration/pose_graph.hpp"

/// What loops of pairwise registrations say about the registrations they consist of.
namespace shapelight::registration {

/// A loop of two edges (between the same scans) or three.
struct Loop {
  std::vector<std::size_t> edges;
  bool agrees = false;  ///< going around it leads back to the start, within the edges' covariances
};

/// All loops of two and of three of the edges with `is_candidate`.
/// Cost: for each edge the edges at one of its ends, and a 6x6 factorisation per loop.
[[nodiscard]] std::vector<Loop> find_loops(std::size_t num_scans, std::span<const PoseGraphEdge> edges,
                                           const std::vector<bool>& is_candidate, double max_chi_sq);

/// Probability that each edge is right, given all loops: loopy belief propagation (sum-product), from the edges' own
/// confidences. A loop of right edges closes; with a wrong one among them it closes by chance only.
[[nodiscard]] std::vector<double> confidence_after_loops(std::span<const PoseGraphEdge> edges,
                                                         std::span<const Loop> loops);

}  // namespace shapelight::registration
