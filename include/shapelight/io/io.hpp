#pragma once

#include <filesystem>
#include <optional>
#include <span>
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
  std::string_view name;                     ///< "ply"
  std::vector<std::string_view> extensions;  ///< with the dot, lower case
  std::string_view description;
  bool can_read = false;
  bool can_write = false;
};
[[nodiscard]] std::span<const FormatInfo> supported_formats();

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
