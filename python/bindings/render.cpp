#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "bindings.hpp"
#include "geometry.hpp"
#include "options.hpp"
#include "run.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/render/color_map.hpp"
#include "shapelight/render/image.hpp"
#include "shapelight/render/panels.hpp"

namespace shapelight::python {
namespace {

using PixelsArray = nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

nb::object picture(Image&& image) {
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  return own_as_numpy<std::uint8_t>(std::move(image.pixels), {height, width, 3});
}

Image to_image(const PixelsArray& pixels) {
  Image image(static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)), {});
  std::memcpy(image.pixels.data(), pixels.data(), pixels.size());
  return image;
}

nb::dict to_dict(FieldColors&& field) {
  const std::size_t n = field.colors.size();
  nb::dict d;
  d["colors"] = own_as_numpy<float>(std::move(field.colors), {n, 3});
  d["name"] = field.legend.name;
  d["map"] = std::string(enum_name(field.legend.map));
  d["min"] = field.legend.min;
  d["max"] = field.legend.max;
  return d;
}

// What there is to draw: everything that is not an option.
struct Subject {
  std::vector<Geometry> geometries;
  std::vector<NamedGeometry> inputs;
  std::vector<std::string> colors;
  std::vector<NamedDots> dots;
  PointSizes sizes;
  std::vector<std::string> titles;

  [[nodiscard]] std::vector<RenderItem> panels() const {
    std::vector<RenderItem> items = make_panels(inputs, colors, dots, sizes);
    if (!titles.empty() && titles.size() != items.size()) {
      throw InvalidInput(fmt::format("titles: {}, expected one for each of {} panels", titles.size(), items.size()));
    }
    for (std::size_t i = 0; i < titles.size(); ++i) items[i].title = titles[i];
    return items;
  }
};

nb::object render_job(const nb::list& inputs, const nb::list& dots, const nb::dict& style, const nb::dict& given,
                      nb::object threads, nb::object progress) {
  RenderOptions options = make_options<RenderOptions>(given);
  options.view = nb::cast<std::string>(style["view"]);
  Subject subject;
  subject.colors = nb::cast<std::vector<std::string>>(style["colors"]);
  subject.titles = nb::cast<std::vector<std::string>>(style["titles"]);
  subject.sizes = {.point = nb::cast<double>(style["point_size"]), .dot = nb::cast<double>(style["dot_size"])};
  subject.geometries.reserve(inputs.size());
  for (const nb::handle named : inputs) {
    subject.geometries.push_back(nb::cast<const InputView&>(named[1]).geometry());
    subject.inputs.push_back({&subject.geometries.back(), nb::cast<std::string>(named[0])});
  }
  for (const nb::handle named : dots) {
    subject.dots.push_back({as_span(nb::cast<PointsArray>(named[1])), nb::cast<std::string>(named[0])});
  }
  const bool captions = nb::cast<bool>(style["captions"]);
  return picture(run({threads, progress}, [&](const RunContext& context) {
    const std::vector<RenderItem> panels = subject.panels();
    if (captions) return render_scene(panels, options, context);
    if (panels.size() != 1) {
      throw InvalidInput(fmt::format("captions: {} panels, expected one when there are none", panels.size()));
    }
    return render(panels[0], options, context);
  }));
}

/// Colours of many numbers: (n, 3).
template <class T, class ColorOf>
nb::object colors_of(const VectorArray<T>& values, ColorOf&& color_of) {
  std::vector<Color> colors;
  colors.reserve(values.shape(0));
  for (const T value : as_span(values)) colors.push_back(color_of(value));
  const std::size_t n = colors.size();
  return own_as_numpy<float>(std::move(colors), {n, 3});
}

Color to_color(const Vec3& c) {
  return {static_cast<float>(c.x()), static_cast<float>(c.y()), static_cast<float>(c.z())};
}

void bind_colors(nb::module_& module) {
  module.def(
      "color_by_values",
      [](const VectorArray<double>& values, const std::string& name) {
        return to_dict(color_by_values(as_span(values), name));
      },
      nb::arg("values"), nb::arg("name"));
  module.def(
      "color_by_field",
      [](const InputView& view, const std::string& field) { return to_dict(color_by_field(view.geometry(), field)); },
      nb::arg("geometry"), nb::arg("field"));
  module.def(
      "map_color",
      [](const std::string& map, const VectorArray<double>& t) {
        ColorMap kind{};
        set_option(OptionInfo{"map", "", ""}, nb::cast(map), kind);
        if (kind == ColorMap::Categorical) throw InvalidInput("map: 'categorical', expected one for numbers");
        return colors_of(t, [&](double value) { return map_color(kind, value); });
      },
      nb::arg("map"), nb::arg("t"));
  module.def(
      "distinct_color", [](const VectorArray<std::int64_t>& labels) { return colors_of(labels, &distinct_color); },
      nb::arg("labels"));
  module.def(
      "value_range",
      [](const VectorArray<double>& values) {
        const ValueRange range = value_range(as_span(values));
        return nb::make_tuple(range.min, range.max);
      },
      nb::arg("values"));
  module.def(
      "to_oklab",
      [](const PointsArray& colors) {
        std::vector<std::array<double, 3>> lab;
        for (const Vec3& c : as_span(colors)) lab.push_back(to_oklab(to_color(c)));
        return own_as_numpy<double>(std::move(lab), {colors.shape(0), 3});
      },
      nb::arg("colors"));
  module.def(
      "from_oklab",
      [](const PointsArray& lab) {
        std::vector<Color> colors;
        for (const Vec3& c : as_span(lab)) colors.push_back(from_oklab({c.x(), c.y(), c.z()}));
        return own_as_numpy<float>(std::move(colors), {lab.shape(0), 3});
      },
      nb::arg("lab"));
  module.def("srgb_to_linear", &srgb_to_linear, nb::arg("value"));
  module.def("linear_to_srgb", &linear_to_srgb, nb::arg("value"));
}

}  // namespace

void bind_render(nb::module_& module) {
  publish_options<RenderOptions>(module, "render");
  module.def("render", &render_job, nb::arg("inputs"), nb::arg("dots"), nb::arg("style"), nb::arg("options"),
             nb::arg("threads").none(), nb::arg("progress").none(),
             "inputs: [(name, GeometryView)], dots: [(name, points)], style: colors, titles, view, sizes, captions.");
  module.def(
      "write_png",
      [](const std::string& path, const PixelsArray& pixels, bool overwrite) {
        write_png(path, to_image(pixels), overwrite);
      },
      nb::arg("path"), nb::arg("pixels"), nb::arg("overwrite"));
  module.def(
      "image_grid",
      [](const std::vector<PixelsArray>& pictures, int columns, int gap,
         const std::array<std::uint8_t, 3>& background) {
        std::vector<Image> images;
        for (const PixelsArray& pixels : pictures) images.push_back(to_image(pixels));
        return picture(image_grid(images, columns, gap, background));
      },
      nb::arg("images"), nb::arg("columns"), nb::arg("gap"), nb::arg("background"));
  module.def(
      "parse_view",
      [](const std::string& text, const InputView& geometry) {
        const View view = parse_view(text, geometry.geometry());
        return nb::make_tuple(to_numpy(view.direction), to_numpy(view.up), view.distance);
      },
      nb::arg("text"), nb::arg("geometry"));
  bind_colors(module);
}

}  // namespace shapelight::python
