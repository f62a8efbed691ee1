#include "bindings.hpp"

namespace shapelight::python {

void bind_features(nb::module_&) {}

}  // namespace shapelight::python
