#include "shapelight/io/io.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "io/formats.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

using Reader = std::function<Geometry(const io::Source&)>;
using Writer =
    std::function<io::DroppedAttributes(io::OutputFile&, const Geometry&, const WriteOptions&, const RunContext&)>;

struct Format {
  std::string name;
  std::vector<std::string> extensions;
  std::string description;
  Reader read;
  Writer write;
};

// A writer that leaves it to the file to look for a stop.
Writer own(io::DroppedAttributes (*write)(io::OutputFile&, const Geometry&, const WriteOptions&)) {
  return [write](io::OutputFile& out, const Geometry& geometry, const WriteOptions& options, const RunContext&) {
    return write(out, geometry, options);
  };
}

// In the order in which they are listed to people.
std::vector<Format>& formats() {
  static std::vector<Format> table = {
      {"ply",
       {".ply"},
       "Polygon File Format: meshes, clouds and Stanford range images",
       io::read_ply,
       own(io::write_ply)},
      {"obj", {".obj"}, "Wavefront OBJ meshes", io::read_obj, own(io::write_obj)},
      {"stl", {".stl"}, "Stereolithography meshes", io::read_stl, own(io::write_stl)},
      {"off", {".off"}, "Object File Format meshes", io::read_off, own(io::write_off)},
      {"pcd", {".pcd"}, "Point Cloud Library clouds and organised clouds", io::read_pcd, own(io::write_pcd)},
      {"xyz",
       {".xyz", ".txt", ".csv", ".pts", ".asc"},
       "clouds as text, one point per line",
       io::read_xyz,
       own(io::write_xyz)},
      {"ptx", {".ptx"}, "terrestrial laser scans as text", io::read_ptx, {}},
      {"las", {".las"}, "ASPRS laser clouds, versions 1.0 to 1.4", io::read_las, own(io::write_las)},
      {"png", {".png"}, "16-bit depth images with camera intrinsics", io::read_depth_png, {}},
      {"osu", {".abs"}, "Ohio State University range images as text", io::read_osu, {}},
      {"rif", {".rif"}, "RIF range images as text", io::read_rif, {}},
      {"laz",
       {".laz"},
       "compressed LAS and COPC (.copc.laz), by the Python package: pip install 'shapelight[las]'",
       {},
       {}},
      {"e57", {".e57"}, "ASTM E57 scans, by the Python package: pip install 'shapelight[e57]'", {}, {}},
  };
  return table;
}

const Format* find_format(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Format& format : formats()) {
    const auto& known = format.extensions;
    if (std::find(known.begin(), known.end(), extension) != known.end()) return &format;
  }
  return nullptr;
}

// "ply obj stl ..." of the formats that can be read or written.
template <class Member>
std::string names_of(Member Format::*function) {
  std::string names;
  for (const Format& format : formats()) {
    if (!(format.*function)) continue;
    for (const std::string& extension : format.extensions)
      names += fmt::format("{}{}", names.empty() ? "" : " ", extension);
  }
  return names;
}

// A geometry without a single finite point is of no use to anybody, whatever its format.
void check_contents(const Geometry& geometry, const Format& format, const std::filesystem::path& path) {
  const auto& points = geometry.positions;
  if (std::any_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); })) return;
  throw FormatError(fmt::format("{}: {}: {} points and none of them finite, expected at least one", format.name,
                                path.string(), points.size()));
}

}  // namespace

std::vector<FormatInfo> supported_formats() {
  std::vector<FormatInfo> list;
  for (const Format& f : formats()) {
    list.push_back({f.name, f.extensions, f.description, f.read != nullptr, f.write != nullptr});
  }
  return list;
}

void register_format(FormatPlugin plugin) {
  for (const std::string& extension : plugin.extensions) {
    const Format* owner = find_format("x" + extension);
    if (owner != nullptr && owner->name != plugin.name) {
      throw InvalidInput(fmt::format("format {}: {} belongs to {} already", plugin.name, extension, owner->name));
    }
  }
  Format format{plugin.name, plugin.extensions, plugin.description, {}, {}};
  if (plugin.read) {
    format.read = [read = std::move(plugin.read)](const io::Source& source) {
      return read(source.path, source.options, source.context);
    };
  }
  if (plugin.write) {
    format.write = [write = std::move(plugin.write)](io::OutputFile& out, const Geometry& geometry,
                                                     const WriteOptions& options, const RunContext& context) {
      return write(out.temporary(), geometry, options, context);
    };
  }
  std::vector<Format>& known = formats();
  const auto same = std::find_if(known.begin(), known.end(), [&](const Format& f) { return f.name == format.name; });
  if (same != known.end()) {
    *same = std::move(format);
  } else {
    known.push_back(std::move(format));
  }
}

void check_writable_format(const std::filesystem::path& path) {
  const Format* format = find_format(path);
  if (format == nullptr || !format->write) {
    throw InvalidInput(
        fmt::format("{}: cannot write this format, expected one of {}", path.string(), names_of(&Format::write)));
  }
}

Geometry read_geometry(const std::filesystem::path& path, const ReadOptions& options, const RunContext& context) {
  const io::MappedFile file(path);  // first: a missing file is that, whatever its name
  const Format* format = find_format(path);
  if (format == nullptr) {
    throw FormatError(fmt::format("{}: unknown extension '{}', expected one of {}", path.string(),
                                  path.extension().string(), names_of(&Format::read)));
  }
  if (!format->read) {
    throw FormatError(
        fmt::format("{}: {} files cannot be read here ({})", path.string(), format->name, format->description));
  }
  context.check();
  Geometry geometry = format->read({file, path, options, context});
  geometry.format = format->name;
  check_contents(geometry, *format, path);
  return geometry;
}

std::vector<std::string> write_geometry(const std::filesystem::path& path, const Geometry& geometry,
                                        const WriteOptions& options, const RunContext& context) {
  check_writable_format(path);
  const Format* format = find_format(path);
  io::OutputFile out(path, options.overwrite, context);
  std::vector<std::string> dropped = format->write(out, geometry, options, context);
  out.commit();
  return dropped;
}

}  // namespace shapelight
