#include "bindings.hpp"

namespace shapelight::python {

void bind_metrics(nb::module_&) {}

}  // namespace shapelight::python
