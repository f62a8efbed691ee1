#include "bindings.hpp"

namespace shapelight::python {

void bind_simplify(nb::module_&) {}

}  // namespace shapelight::python
