#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

/// What the rival programs share: triangle meshes in OFF files, and one line of JSON about the run.
namespace rivals {

using Point = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;

struct OffMesh {
  std::vector<Point> points;
  std::vector<Triangle> triangles;
};

/// Reads "OFF", the three counts, points and triangles; no comments. 17 digits in, the same doubles out.
inline OffMesh read_off(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  if (text.rfind("OFF", 0) != 0) throw std::runtime_error(path + ": expected an OFF file");
  char* at = const_cast<char*>(text.c_str()) + 3;
  OffMesh mesh;
  mesh.points.resize(std::strtoul(at, &at, 10));
  mesh.triangles.resize(std::strtoul(at, &at, 10));
  std::strtoul(at, &at, 10);
  for (Point& point : mesh.points)
    for (double& coordinate : point) coordinate = std::strtod(at, &at);
  for (Triangle& triangle : mesh.triangles) {
    if (std::strtoul(at, &at, 10) != 3) throw std::runtime_error(path + ": expected triangles");
    for (std::uint32_t& corner : triangle) {
      corner = static_cast<std::uint32_t>(std::strtoul(at, &at, 10));
      if (corner >= mesh.points.size()) throw std::runtime_error(path + ": a corner beyond the vertices");
    }
  }
  return mesh;
}

inline void write_off(const std::string& path, const OffMesh& mesh) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) throw std::runtime_error(path + ": cannot be written");
  std::fprintf(file, "OFF\n%zu %zu 0\n", mesh.points.size(), mesh.triangles.size());
  for (const Point& p : mesh.points) std::fprintf(file, "%.17g %.17g %.17g\n", p[0], p[1], p[2]);
  for (const Triangle& t : mesh.triangles) std::fprintf(file, "3 %u %u %u\n", t[0], t[1], t[2]);
  if (std::fclose(file) != 0) throw std::runtime_error(path + ": cannot be written");
}

/// CPU seconds of this process.
inline double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace rivals
