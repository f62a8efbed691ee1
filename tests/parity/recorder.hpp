#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "shapelight/core/types.hpp"
#include "shapelight/io/io.hpp"

/// Writes what C++ functions return as raw bytes, one file per result, for the tests of the Python package to compare.
namespace shapelight::parity {

class Recorder {
 public:
  explicit Recorder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Results are named "function" or "function.member" or "function.case.member".
  template <class T>
  void record(const std::string& name, std::span<const T> values) const {
    std::ofstream file(folder_ / (name + ".bin"), std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
    if (!file) throw std::runtime_error("cannot write " + name);
  }
  template <class T>
  void record(const std::string& name, const std::vector<T>& values) const {
    record(name, std::span<const T>(values));
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void record(const std::string& name, T value) const { record(name, std::span<const T>(&value, 1)); }
  /// Row-major.
  void record(const std::string& name, const RigidTransform& transform) const {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = transform.matrix();
    record(name, std::span<const double>(rows.data(), 16));
  }

 private:
  std::filesystem::path folder_;
};

/// A file that the repository ships: "meshes/fandisk.off".
[[nodiscard]] inline Geometry data(const std::string& name) {
  return read_geometry(std::filesystem::path(SHAPELIGHT_DATA_DIR) / name);
}

// One per source file.
void record_jobs(const Recorder& recorder);
void record_graph(const Recorder& recorder);
void record_features(const Recorder& recorder);
void record_samplers(const Recorder& recorder);
void record_spatial(const Recorder& recorder);
void record_metrics(const Recorder& recorder);
void record_simplify(const Recorder& recorder);
void record_registration(const Recorder& recorder);
void record_synthetic(const Recorder& recorder);
void record_render(const Recorder& recorder);

}  // namespace shapelight::parity
