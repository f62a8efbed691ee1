#pragma once

#include <nanobind/nanobind.h>

/// One function per source file: each adds its part of the library to the module.
namespace shapelight::python {

namespace nb = nanobind;

void translate_errors();
void bind_run(nb::module_& module);
void bind_data(nb::module_& module);
void bind_io(nb::module_& module);
void bind_command_line(nb::module_& module);
void bind_graph(nb::module_& module);
void bind_features(nb::module_& module);
void bind_samplers(nb::module_& module);
void bind_spatial(nb::module_& module);
void bind_metrics(nb::module_& module);
void bind_simplify(nb::module_& module);
void bind_registration(nb::module_& module);
void bind_pose_graph(nb::module_& module);
void bind_synthetic(nb::module_& module);
void bind_render(nb::module_& module);
void bind_jobs(nb::module_& module);
void bind_scan_jobs(nb::module_& module);

}  // namespace shapelight::python
