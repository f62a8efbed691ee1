#include "bindings.hpp"

namespace shapelight::python {

void bind_samplers(nb::module_&) {}

}  // namespace shapelight::python
