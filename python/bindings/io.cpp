#include "shapelight/io/io.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "geometry.hpp"
#include "run.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/io/transform.hpp"

namespace shapelight::python {
namespace {

ReadOptions read_options(const std::optional<std::array<double, 4>>& intrinsics, double depth_scale) {
  ReadOptions options;
  if (intrinsics) options.intrinsics = {(*intrinsics)[0], (*intrinsics)[1], (*intrinsics)[2], (*intrinsics)[3]};
  options.depth_scale = depth_scale;
  return options;
}

// An exception of a Python reader or writer, as the library's own.
[[noreturn]] void rethrow(nb::python_error& error, const std::filesystem::path& path) {
  const nb::module_ errors = nb::module_::import_("shapelight.errors");
  if (!error.matches(errors.attr("Error"))) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
  const std::string what = nb::str(error.value()).c_str();
  switch (nb::cast<int>(error.value().attr("code"))) {
    case 2:
      throw InvalidInput(what);
    case 3:
      throw ReadError(what);
    case 7:
      throw BudgetExceeded(what);
    case 8:
      throw WriteError(what);
    case 130:
      throw Cancelled();
    default:
      throw FormatError(what);
  }
}

// Python's functions, called from the library's threads. They are never freed: formats live as long as the process.
template <class Call>
auto with_python(const std::filesystem::path& path, Call&& call) {
  const nb::gil_scoped_acquire acquire;
  try {
    return call();
  } catch (nb::python_error& error) {
    rethrow(error, path);
  }
}

FormatPlugin::Read reader(const nb::object& function) {
  if (function.is_none()) return {};
  return
      [f = new nb::object(function)](const std::filesystem::path& path, const ReadOptions&, const RunContext& context) {
        return with_python(path, [&] {
          const nb::object geometry = (*f)(path.string(), nb::cast(&context, nb::rv_policy::reference));
          return nb::cast<const InputView&>(geometry.attr("_view")()).geometry();
        });
      };
}

FormatPlugin::Write writer(const nb::object& function) {
  if (function.is_none()) return {};
  return [f = new nb::object(function)](const std::filesystem::path& temporary, const Geometry& geometry,
                                        const WriteOptions&, const RunContext& context) {
    return with_python(temporary, [&] {
      const nb::object type = nb::module_::import_("shapelight.geometry").attr("Geometry");
      const nb::object copy = type(**to_dict(Geometry(geometry)));
      return nb::cast<std::vector<std::string>>(
          (*f)(temporary.string(), copy, nb::cast(&context, nb::rv_policy::reference)));
    });
  };
}

}  // namespace

void bind_io(nb::module_& module) {
  nb::class_<RunContext>(module, "RunContext", "How a reader or writer of a registered format is to run.")
      .def("check", &RunContext::check, "Raises Cancelled when a stop was requested.")
      .def(
          "report", [](const RunContext& c, double fraction) { c.report(fraction); }, nb::arg("fraction"));
  module.def(
      "read_geometry",
      [](const std::string& path, const std::optional<std::array<double, 4>>& intrinsics, double depth_scale,
         nb::object threads, nb::object progress) {
        return to_dict(run({threads, progress}, [&](const RunContext& context) {
          return read_geometry(path, read_options(intrinsics, depth_scale), context);
        }));
      },
      nb::arg("path"), nb::arg("intrinsics").none(), nb::arg("depth_scale"), nb::arg("threads").none(),
      nb::arg("progress").none());
  module.def(
      "write_geometry",
      [](const std::string& path, const InputView& view, bool ascii, bool overwrite, nb::object threads,
         nb::object progress) {
        const Geometry geometry = view.geometry();
        return run({threads, progress}, [&](const RunContext& context) {
          return write_geometry(path, geometry, {.ascii = ascii, .overwrite = overwrite}, context);
        });
      },
      nb::arg("path"), nb::arg("geometry"), nb::arg("ascii"), nb::arg("overwrite"), nb::arg("threads").none(),
      nb::arg("progress").none());
  module.def("supported_formats", [] {
    nb::list formats;
    for (const FormatInfo& f : supported_formats()) {
      nb::dict row;
      row["name"] = f.name;
      row["extensions"] = f.extensions;
      row["description"] = f.description;
      row["can_read"] = f.can_read;
      row["can_write"] = f.can_write;
      formats.append(row);
    }
    return formats;
  });
  module.def(
      "register_format",
      [](std::string name, std::vector<std::string> extensions, std::string description, nb::object read,
         nb::object write) {
        register_format({std::move(name), std::move(extensions), std::move(description), reader(read), writer(write)});
      },
      nb::arg("name"), nb::arg("extensions"), nb::arg("description"), nb::arg("read").none(), nb::arg("write").none());
  module.def(
      "read_transform", [](const std::string& path) { return to_numpy(read_transform(path)); }, nb::arg("path"));
  module.def(
      "write_transform",
      [](const std::string& path, const PoseArray& transform, bool overwrite) {
        write_transform(path, to_transform(transform), overwrite);
      },
      nb::arg("path"), nb::arg("transform"), nb::arg("overwrite"));
}

}  // namespace shapelight::python
