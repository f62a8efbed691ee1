#include "command_line.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "bindings.hpp"
#include "run.hpp"
#include "shapelight/pipeline/memory_estimate.hpp"
#include "values.hpp"

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
  // What people type means the same to the command and to Python.
  module.def("parse_count", &cli::parse_count, nb::arg("option"), nb::arg("text"), "1200, 50k, 2M.");
  module.def("parse_ratio", &cli::parse_ratio, nb::arg("option"), nb::arg("text"), "0.1 or 10%.");
  module.def(
      "parse_length",
      [](std::string_view option, std::string_view text, double diagonal) {
        return cli::parse_length(option, text).resolve(diagonal);
      },
      nb::arg("option"), nb::arg("text"), nb::arg("diagonal"), "A length, or 2% of the diagonal.");
  module.def("parse_bytes", &cli::parse_bytes, nb::arg("option"), nb::arg("text"), "512M, 2G.");
  nb::dict bytes;
  bytes["sample"] = kSampleBytesPerPoint;
  bytes["fields"] = kFieldsBytesPerPoint;
  bytes["simplify"] = kSimplifyBytesPerPoint;
  bytes["register"] = kRegisterBytesPerPoint;
  bytes["align"] = kRegisterBytesPerPoint;
  module.attr("bytes_per_point") = bytes;
}

}  // namespace shapelight::python
