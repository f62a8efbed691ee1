#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"
#include "shapelight/io/io.hpp"
#include "io/mapped_file.hpp"
#include "io/output_file.hpp"

/// One reader and one writer per format, each in its own source file. Readers get the mapped file; `path` is for
/// messages and for files beside it. Writers get a file that the caller commits, and return the attributes left out.
namespace shapelight::io {

struct Source {
  const MappedFile& file;
  const std::filesystem::path& path;
  const ReadOptions& options;
  const RunContext& context;
};

Geometry read_ply(const Source& source);
Geometry read_obj(const Source& source);
Geometry read_stl(const Source& source);
Geometry read_off(const Source& source);
Geometry read_pcd(const Source& source);
Geometry read_las(const Source& source);
Geometry read_xyz(const Source& source);        // .xyz .txt .csv .pts .asc
Geometry read_ptx(const Source& source);
Geometry read_depth_png(const Source& source);
Geometry read_osu(const Source& source);        // .abs
Geometry read_rif(const Source& source);

using DroppedAttributes = std::vector<std::string>;
DroppedAttributes write_ply(OutputFile& out, const Geometry& geometry, const WriteOptions& options);
DroppedAttributes write_obj(OutputFile& out, const Geometry& geometry, const WriteOptions& options);
DroppedAttributes write_stl(OutputFile& out, const Geometry& geometry, const WriteOptions& options);
DroppedAttributes write_off(OutputFile& out, const Geometry& geometry, const WriteOptions& options);
DroppedAttributes write_pcd(OutputFile& out, const Geometry& geometry, const WriteOptions& options);
DroppedAttributes write_las(OutputFile& out, const Geometry& geometry, const WriteOptions& options);
DroppedAttributes write_xyz(OutputFile& out, const Geometry& geometry, const WriteOptions& options);

}  // namespace shapelight::io
