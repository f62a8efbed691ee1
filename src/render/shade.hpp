#pragma once

#include "render/raster.hpp"

namespace shapelight::drawing {

/// Light that reaches each pixel past its surroundings, in [0, 1]: one value per `supersample`^2 samples of the frame.
/// Sixteen places around the pixel are asked whether they rise above its tangent plane.
std::vector<float> ambient_light(const Frame& frame, const Camera& camera, int supersample, double strength,
                                 const RunContext& context);

/// A marker drawn over the picture. [samples]
struct Dot {
  float x = 0.0F;
  float y = 0.0F;
  float nearness = 0.0F;
};

/// The dots that the surface does not hide, far ones first.
std::vector<Dot> visible_dots(std::span<const Vec3> points, const Frame& frame, const Camera& camera);

struct DotStyle {
  Color color{};
  float radius = 0.0F;  ///< [samples]
  float rim = 0.0F;     ///< [samples] width of the dark rim, within the radius
};

/// Lights the samples, draws the dots over them and averages each block of samples, in linear light, to a pixel.
Image shade(const Frame& frame, std::span<const float> ambient, std::span<const Dot> dots, const DotStyle& style,
            Pixel background, int supersample, const RunContext& context);

}  // namespace shapelight::drawing
