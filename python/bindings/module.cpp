#include <nanobind/nanobind.h>

#include "bindings.hpp"

NB_MODULE(_core, module) {
  using namespace shapelight::python;
  module.doc() = "The C++ library. Use it through the package shapelight, which checks and converts what comes in.";
  module.attr("version") = SHAPELIGHT_VERSION;
  module.attr("option_tables") = nanobind::dict();
  translate_errors();
  bind_run(module);
  bind_data(module);
  bind_io(module);
  bind_command_line(module);
  bind_graph(module);
  bind_features(module);
  bind_samplers(module);
  bind_spatial(module);
  bind_metrics(module);
  bind_simplify(module);
  bind_registration(module);
  bind_pose_graph(module);
  bind_synthetic(module);
  bind_render(module);
  bind_jobs(module);
  bind_scan_jobs(module);
}
