#include "bindings.hpp"

namespace shapelight::python {

void bind_spatial(nb::module_&) {}

}  // namespace shapelight::python
