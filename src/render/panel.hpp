#pragma once

#include "render/camera.hpp"
#include "shapelight/render/renderer.hpp"

namespace shapelight::drawing {

/// Throws InvalidInput: no geometry, or colours of the wrong number.
void check_item(const RenderItem& item);

/// The picture of one item as a camera for width x height pixels sees it.
Image draw_panel(const RenderItem& item, const Camera& camera, int width, int height, const RenderOptions& options,
                 const RunContext& context);

}  // namespace shapelight::drawing
