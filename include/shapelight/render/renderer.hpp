#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shapelight/core/options.hpp"
#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/render/field_colors.hpp"
#include "shapelight/render/image.hpp"

namespace shapelight {

/// How one looks at an object.
struct View {
  Vec3 direction = {0.0, 0.0, -1.0};  ///< unit, from the eye into the scene, input frame
  Vec3 up = {0.0, 1.0, 0.0};          ///< unit, perpendicular to direction
  double distance = 0.0;              ///< [input length unit] of the eye from the box's centre; 0: by the field of view
};

/// Parses a viewpoint: where the eye is, seen from the object. "front", "back", "left", "right", "top", "bottom", "iso"
/// (all three in front, right and above), "x,y,z" (a direction in the input frame), or "auto".
///
/// Up is chosen from the data: -y in a depth camera's frame (sensor known, looking along +z); z for laser formats (las,
/// ptx), when the z extent exceeds 1.3 times the others (statues) or is below a quarter of both (terrain); else y.
/// "auto" looks from the sensor when it is known (from its very place at a range image), along -z at range images
/// without one, from above at terrain, and at all other things from a little right of and above the front.
/// Throws InvalidInput that lists what is understood.
[[nodiscard]] View parse_view(std::string_view text, const Geometry& geometry);

/// One thing to draw. Triangles are drawn when there are any, a range image's grid is triangulated (cut at depth
/// jumps), and points become discs that close the surface. Non-finite points are skipped.
struct RenderItem {
  const Geometry* geometry = nullptr;
  std::vector<Vec3> point_normals{};  ///< per point; empty: from triangles, from columns nx ny nz, or from neighbours
  std::vector<Color> colors{};        ///< per point; empty: neutral clay
  Legend legend{};                    ///< colour bar under the picture; none when its name is empty
  bool flat_colors = false;           ///< the nearest vertex's colour instead of a blend; categorical legends imply it
  double point_radius = 0.0;          ///< [pixels] of a point's disc; 0: from the spacing of its neighbours
  std::vector<Vec3> dots{};           ///< input frame; drawn over the surface where they are not hidden by it
  Color dot_color = {0.86F, 0.22F, 0.10F};
  double dot_radius = 0.0;  ///< [pixels] 0: from the number of dots
  std::string title{};      ///< caption under the picture; ASCII
};

struct RenderOptions {
  int width = 1200;             ///< [pixels] of the whole picture
  int height = 900;             ///< [pixels]
  int supersample = 2;          ///< rays per pixel and axis: the edges' smoothness
  double field_of_view = 20.0;  ///< [deg] of the perspective along the shorter side; tiny: orthographic
  double occlusion = 1.0;       ///< [1] darkness of corners and crevices
  Pixel background = {255, 255, 255};
  std::string view = "auto";  ///< see parse_view()

  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"width", "pixels", "Width of the picture.", 16, 16384}, o.width);
    visit(OptionInfo{"height", "pixels", "Height of the picture.", 16, 16384}, o.height);
    visit(OptionInfo{"supersample", "samples per pixel and axis", "Smoothness of edges.", 1, 4}, o.supersample);
    visit(OptionInfo{"field-of-view", "deg", "Strength of the perspective; 0.1 is orthographic.", 0.1, 90},
          o.field_of_view);
    visit(OptionInfo{"occlusion", "1", "Darkness of corners and crevices.", 0, 2}, o.occlusion);
  }
};

/// Draws one item without caption and legend: a z-buffer with shading per pixel (a key light, a headlight, light
/// from the sky, ambient occlusion in screen space); both sides of a surface are lit. Points are discs in the tangent
/// plane, blended where they overlap.
/// Throws InvalidInput (no geometry, no finite point, wrong number of colours or normals, a triangle that names a
/// missing vertex, options out of range), Cancelled.
/// Cost: O(triangles + pixels), 24 bytes per pixel and supersample^2; clouds without normals O(n log n).
/// Same bytes for any number of threads.
[[nodiscard]] Image render(const RenderItem& item, const RenderOptions& options = {}, const RunContext& context = {});

/// Draws items as the panels of one picture, in a row up to three, else in a grid, each over its caption and legend.
/// Items with nearly the same bounding box share the first one's camera, so that they can be compared.
/// Throws like render(), and InvalidInput for no items or panels too small to draw.
[[nodiscard]] Image render_scene(std::span<const RenderItem> items, const RenderOptions& options = {},
                                 const RunContext& context = {});

}  // namespace shapelight
