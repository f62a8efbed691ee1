#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "shapelight/core/error.hpp"
#include "shapelight/io/io.hpp"

/// Files made by tests, and geometries compared bit for bit.
namespace shapelight::test {

/// A folder that goes away with the object.
class TempFolder {
 public:
  TempFolder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            ("shapelight_" + std::to_string(::getpid()) + "_" + info->test_suite_name() + "_" + info->name());
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path_ / name; }
  [[nodiscard]] std::filesystem::path file(const std::string& name, std::string_view contents) const {
    std::ofstream(path_ / name, std::ios::binary) << contents;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string contents_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::filesystem::path data_file(const std::string& name) {
  return std::filesystem::path(SHAPELIGHT_DATA_DIR) / name;
}

/// The message of the FormatError that reading must end in; empty when it does not.
inline std::string refusal(const std::filesystem::path& path) {
  try {
    (void)read_geometry(path);
  } catch (const FormatError& error) {
    return error.what();
  }
  return "";
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same(const AttributeTable& a, const AttributeTable& b) {
  ASSERT_EQ(a.columns().size(), b.columns().size());
  for (std::size_t i = 0; i < a.columns().size(); ++i) {
    EXPECT_EQ(a.columns()[i].name, b.columns()[i].name);
    ASSERT_EQ(a.columns()[i].type(), b.columns()[i].type()) << a.columns()[i].name;
    std::visit(
        [&]<class T>(const std::vector<T>& values) {
          EXPECT_TRUE(same_bits(values, std::get<std::vector<T>>(b.columns()[i].values))) << a.columns()[i].name;
        },
        a.columns()[i].values);
  }
}

/// Everything that a file can hold, but for the warnings and the LAS header.
inline void expect_same(const Geometry& a, const Geometry& b) {
  EXPECT_TRUE(same_bits(a.positions, b.positions));
  EXPECT_EQ(a.coordinate_type, b.coordinate_type);
  expect_same(a.attributes, b.attributes);
  EXPECT_EQ(a.triangles, b.triangles);
  expect_same(a.triangle_attributes, b.triangle_attributes);
  EXPECT_EQ(a.corner_texcoords, b.corner_texcoords);
  EXPECT_EQ(a.viewpoint, b.viewpoint);
  EXPECT_EQ(a.comments, b.comments);
  ASSERT_EQ(a.grid.has_value(), b.grid.has_value());
  if (a.grid) {
    EXPECT_EQ(a.grid->width, b.grid->width);
    EXPECT_EQ(a.grid->height, b.grid->height);
    EXPECT_EQ(a.grid->pixel, b.grid->pixel);
  }
}

}  // namespace shapelight::test
