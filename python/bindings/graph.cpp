#include "bindings.hpp"

namespace shapelight::python {

void bind_graph(nb::module_&) {}

}  // namespace shapelight::python
