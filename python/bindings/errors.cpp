#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::python {
namespace {

// Raises the class of shapelight.errors that has this name.
void raise(const char* name, const Error& error) {
  const nb::module_ errors = nb::module_::import_("shapelight.errors");
  const nb::object type = errors.attr(name);
  const nb::object exception = type(errors.attr("in_keywords")(std::string(error.what())));
  if (const auto* unreachable = dynamic_cast<const TargetUnreachable*>(&error)) {
    exception.attr("reachable") = unreachable->reachable();
  }
  PyErr_SetObject(type.ptr(), exception.ptr());
}

const char* class_name(const Error& error) {
  switch (error.exit_code()) {
    case 2:
      return "InvalidInput";
    case 3:
      return "ReadError";
    case 4:
      return "FormatError";
    case 5:
      return "TargetUnreachable";
    case 6:
      return "PostconditionFailed";
    case 7:
      return "BudgetExceeded";
    case 8:
      return "WriteError";
    case 130:
      return "Cancelled";
    default:
      return "Error";
  }
}

}  // namespace

void translate_errors() {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(class_name(error), error);
    }
  });
}

}  // namespace shapelight::python
