#pragma once

#include <string_view>

#include "shapelight/render/image.hpp"

namespace shapelight::drawing {

/// Width of a line of text. `size` is the height of a capital letter. [pixels]
double text_width(std::string_view text, double size);

/// Draws ASCII text in a stroked font, anti-aliased; other bytes show as '?'. (left, baseline) in pixels; parts outside
/// the image are left out.
void draw_text(Image& image, std::string_view text, double left, double baseline, double size, Pixel color);

}  // namespace shapelight::drawing
