#pragma once

#include <vector>

#include "shapelight/spatial/triangle_tree.hpp"
#include "spatial/box_tree.hpp"

namespace shapelight {

// Everything is moved to the middle of the mesh and scaled by a power of two into [-1, 1]: boxes keep their precision
// at any offset, squares neither overflow nor vanish, and scaling rounds nothing.
struct TriangleTree::Impl {
  struct Corners {
    Vec3 a, b, c;
    Index triangle;
  };
  struct Best;
  Vec3 center = Vec3::Zero();
  double scale = 1.0;
  BoxTree tree;
  std::vector<Corners> corners;  // in the order of the tree
  std::vector<Index> place;      // of each triangle in that order

  Impl(const TriangleMesh& mesh, const RunContext& context);
  void choose_frame(const TriangleMesh& mesh);
  [[nodiscard]] Vec3 to_local(const Vec3& p) const { return (p - center) * scale; }
  [[nodiscard]] Hit closest(const Vec3& query, Index hint) const;
  void search(const Vec3& query, Best& best) const;
  [[nodiscard]] RayHit first_hit(const Vec3& origin, const Vec3& direction) const;
  void prefetch(std::uint32_t child) const {
    if (child & BoxNode::kItem) {
      __builtin_prefetch(&corners[child & ~BoxNode::kItem]);
    } else {
      __builtin_prefetch(&tree.nodes[child]);
    }
  }
};

}  // namespace shapelight
