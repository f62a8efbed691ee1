#include "bindings.hpp"

namespace shapelight::python {

void bind_registration(nb::module_&) {}

}  // namespace shapelight::python
