#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "io/formats.hpp"
#include "shapelight/core/error.hpp"

/// Files made by tests, and one reader or writer called without the registry.
namespace shapelight::io::test {

using Reader = Geometry (*)(const Source&);
using Writer = DroppedAttributes (*)(OutputFile&, const Geometry&, const WriteOptions&);

/// A folder of its own for one test, removed with all its files at the end.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "shapelight_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path write(std::string_view name, std::string_view contents) const {
    const std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary).write(contents.data(), static_cast<std::streamsize>(contents.size()));
    return file;
  }
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline Geometry read_path(Reader reader, const std::filesystem::path& path, const ReadOptions& options = {}) {
  const MappedFile file(path);
  return reader({file, path, options, {}});
}

inline Geometry read_text(Reader reader, std::string_view text) {
  const TempFolder folder;
  return read_path(reader, folder.write("input", text));
}

/// The message of the FormatError that reading the text ends in; a failure of the test if it does not.
inline std::string error_of(Reader reader, std::string_view text) {
  try {
    (void)read_text(reader, text);
  } catch (const FormatError& error) {
    return error.what();
  }
  ADD_FAILURE() << "read without an error:\n" << text.substr(0, 200);
  return {};
}

inline testing::AssertionResult contains(const std::string& text, std::string_view part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << part << "' is not in '" << text << "'";
}

struct Written {
  std::string bytes;
  DroppedAttributes dropped;
};

inline Written write_bytes(Writer writer, const Geometry& geometry, const WriteOptions& options = {}) {
  const TempFolder folder;
  OutputFile out(folder / "output", false);
  DroppedAttributes dropped = writer(out, geometry, options);
  out.commit();
  return {slurp(folder / "output"), std::move(dropped)};
}

inline std::vector<double> column(const Geometry& geometry, std::string_view name) {
  const Column* found = geometry.attributes.find(name);
  return found == nullptr ? std::vector<double>{} : found->to_doubles();
}

/// Two triangles over four vertices whose coordinates are not floats.
inline Geometry square() {
  Geometry geometry;
  geometry.positions = {{0.1, 0, 0}, {1.1, 0, 0}, {1.1, 1, 0.3}, {0.1, 1, 0}};
  geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
  return geometry;
}

}  // namespace shapelight::io::test
