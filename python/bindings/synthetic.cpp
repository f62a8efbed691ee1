#include "bindings.hpp"

namespace shapelight::python {

void bind_synthetic(nb::module_&) {}

}  // namespace shapelight::python
