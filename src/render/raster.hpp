#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/surface.hpp"

namespace shapelight::drawing {

/// What is seen at one sample of the picture.
struct Fragment {
  float nearness = 0.0F;                ///< see ScreenPoint; 0: background
  std::array<float, 3> normal{};        ///< camera frame, unit, towards the eye; zero where undefined
  std::array<std::uint8_t, 3> color{};  ///< sRGB
};

struct Frame {
  int width = 0;
  int height = 0;
  std::vector<Fragment> fragments;  ///< row by row
  [[nodiscard]] const Fragment& at(int x, int y) const { return fragments[static_cast<std::size_t>(y) * width + x]; }
};

/// Colours and rules of drawing a surface.
struct Paint {
  std::span<const Color> colors;  ///< per point; empty: `plain`
  Color plain{};
  bool flat = false;          ///< the nearest corner's colour
  double point_radius = 0.0;  ///< [samples] 0: surface.radius
};

/// Draws into a frame of `width` x `height` samples. The picture is cut into bands of rows; each band walks the
/// primitives in their order, so depth ties go to the lower index whatever the number of threads.
Frame rasterize(const Geometry& geometry, const Surface& surface, const Paint& paint, const Camera& camera, int width,
                int height, const RunContext& context);

}  // namespace shapelight::drawing
