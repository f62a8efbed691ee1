#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"

namespace shapelight {

/// Pinhole camera of a depth image: x = (column - cx) z / fx, y = (row - cy) z / fy, z along the view. [pixels]
struct CameraIntrinsics {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
};

struct ReadOptions {
  std::optional<CameraIntrinsics> intrinsics;  ///< depth images; else a text file beside the image is looked for
  double depth_scale = 1000.0;                 ///< [steps per output length unit] depth = value / depth_scale
};

struct WriteOptions {
  bool ascii = false;      ///< text instead of binary where the format has both
  bool overwrite = false;  ///< allow replacing an existing file
};

/// One supported file format.
struct FormatInfo {
  std::string name;                     ///< "ply"
  std::vector<std::string> extensions;  ///< with the dot, lower case
  std::string description;
  bool can_read = false;
  bool can_write = false;
};
[[nodiscard]] std::vector<FormatInfo> supported_formats();

/// A format that another library reads or writes. Either function may be empty.
struct FormatPlugin {
  using Read = std::function<Geometry(const std::filesystem::path&, const ReadOptions&, const RunContext&)>;
  /// Writes to `temporary`, an empty file beside the target that is renamed afterwards; returns the names of attributes
  /// that the format cannot hold.
  using Write = std::function<std::vector<std::string>(const std::filesystem::path& temporary, const Geometry&,
                                                       const WriteOptions&, const RunContext&)>;
  std::string name;                     ///< of a known format ("laz") or a new one
  std::vector<std::string> extensions;  ///< with the dot, lower case
  std::string description;
  Read read;
  Write write;
};
/// Makes the format known to read_geometry() and write_geometry(), for the whole process; one of the same name is
/// replaced. Call it before reading and writing begins: it must not run beside them.
/// Throws InvalidInput when an extension belongs to a format of another name.
void register_format(FormatPlugin plugin);

/// Throws InvalidInput when no writer fits the path's extension; names the extensions that have one.
void check_writable_format(const std::filesystem::path& path);

/// Reads a mesh, range image or point cloud; the format is chosen by extension (case-insensitive).
/// The file is memory-mapped, and every count is checked against the bytes that are there before memory is allocated.
/// Throws ReadError (missing, unreadable), FormatError (malformed or unsupported; names line, byte, element or index,
/// and what was expected), Cancelled. Cost: linear in the file's size.
[[nodiscard]] Geometry read_geometry(const std::filesystem::path& path, const ReadOptions& options = {},
                                     const RunContext& context = {});

/// Writes in the format of the extension: to a temporary file beside the target, then renamed, so that the target is
/// either old or complete. Returns the names of attributes that the format cannot hold, if any.
/// Throws InvalidInput (unknown extension), WriteError (exists and overwrite is off, no space, ...).
std::vector<std::string> write_geometry(const std::filesystem::path& path, const Geometry& geometry,
                                        const WriteOptions& options = {}, const RunContext& context = {});

}  // namespace shapelight
