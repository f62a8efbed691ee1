#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "shapelight/core/run_context.hpp"
#include "shapelight/data/geometry.hpp"

namespace shapelight::bench {

struct Job {
  std::string name;
  std::function<void(const RunContext&)> work;
};

/// What the jobs work on; it must outlive them.
struct JobInput {
  Geometry mesh;                 ///< with attributes
  Geometry cloud;                ///< the same points without triangles
  Geometry coarse;               ///< a simpler version of the mesh
  Geometry crossed;              ///< the mesh and a face across it: an edge of three faces
  std::vector<Geometry> clouds;  ///< the points of the scans
  std::vector<Geometry> scans;   ///< range images of the mesh, each overlapping the next
  std::filesystem::path folder;  ///< for files
  std::filesystem::path written(const std::string& name) const { return folder / name; }
};

/// At least `points` vertices, cut from the mesh; scans of about as many points.
[[nodiscard]] JobInput make_input(const Geometry& mesh, std::size_t points, const std::filesystem::path& folder);

/// Every long call of the library: files of all formats, all samplers, presets and methods.
[[nodiscard]] std::vector<Job> all_jobs(const JobInput& input);

}  // namespace shapelight::bench
