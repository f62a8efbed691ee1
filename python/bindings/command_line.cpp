#include "command_line.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "bindings.hpp"
#include "run.hpp"

namespace shapelight::python {

void bind_command_line(nb::module_& module) {
  module.def(
      "run_command_line",
      [](const std::vector<std::string>& arguments) {
        std::vector<const char*> argv;
        for (const std::string& argument : arguments) argv.push_back(argument.c_str());
        return run({}, [&](const RunContext& context) {
          return cli::run_command_line(static_cast<int>(argv.size()), argv.data(), context.stop);
        });
      },
      nb::arg("arguments"),
      "Runs the shapelight command; arguments[0] is its name. Returns the exit code. A signal whose Python handler "
      "raises stops it.");
}

}  // namespace shapelight::python
