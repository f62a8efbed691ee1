// The C++ side of overhead.py: runs one job on raw arrays, once for every line on standard input, and answers with
// "wall_seconds cpu_seconds peak_bytes", the peak above what was there before the call.
//
//   call_cost JOB THREADS POINTS [POINTS2 | TRIANGLES]    files of float64 x 3 (points) and uint32 x 3 (triangles)

#include <fmt/format.h>
#include <malloc.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "shapelight/pipeline/register.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/pipeline/simplify.hpp"

namespace {

using namespace shapelight;

template <class T>
std::vector<T> read_rows(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::vector<T> rows(static_cast<std::size_t>(file.tellg()) / sizeof(T));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(rows.data()), static_cast<std::streamsize>(rows.size() * sizeof(T)));
  if (!file) throw std::runtime_error(path + ": cannot read");
  return rows;
}

double status_bytes(const char* name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name)) return 1024.0 * std::strtod(line.c_str() + std::string(name).size(), nullptr);
  }
  return 0.0;
}

std::function<void()> job_named(const std::string& name, const RunContext& context,
                                const std::vector<std::string>& files) {
  const auto points = [&](std::size_t i) {
    auto geometry = std::make_shared<Geometry>();
    geometry->positions = read_rows<Vec3>(files.at(i));
    return geometry;
  };
  const auto mesh = [&] {
    auto geometry = points(0);
    geometry->triangles = read_rows<Triangle>(files.at(1));
    return geometry;
  };
  if (name == "sample-cloud" || name == "sample-mesh") {
    return [input = name == "sample-mesh" ? mesh() : points(0), context] {
      (void)sample(*input, {.count = {}, .ratio = 0.1, .spacing = {}}, sample_preset(Preset::Detail), context);
    };
  }
  if (name == "simplify") {
    return [input = mesh(), context] {
      (void)simplify(*input, {.vertices = {}, .faces = {}, .ratio = 0.1, .max_error = {}},
                     simplify_preset(SimplifyPreset::Detail), context);
    };
  }
  if (name == "register") {
    return
        [source = points(0), target = points(1), context] { (void)register_scans(*source, *target, {}, {}, context); };
  }
  throw std::runtime_error(name + ": expected sample-cloud, sample-mesh, simplify or register");
}

void measure(const std::function<void()>& job) {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
  const double before = status_bytes("VmRSS:");
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  job();
  const double cpu_seconds = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  const double wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  fmt::print("{} {} {}\n", wall_seconds, cpu_seconds, status_bytes("VmHWM:") - before);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: call_cost JOB THREADS POINTS [POINTS2 | TRIANGLES]\n");
    return 2;
  }
  try {
    const RunContext context{std::atoi(argv[2]), {}, {}};
    const std::function<void()> job = job_named(argv[1], context, {argv + 3, argv + argc});
    for (std::string line; std::getline(std::cin, line);) measure(job);
  } catch (const std::exception& error) {
    fmt::print(stderr, "call_cost: {}\n", error.what());
    return 1;
  }
  return 0;
}
