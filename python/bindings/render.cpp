#include "bindings.hpp"

namespace shapelight::python {

void bind_render(nb::module_&) {}

}  // namespace shapelight::python
