#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace shapelight::cli {

/// Files that appear together: they are made in a folder of their own and moved to the target on commit(). Destroyed
/// without commit(), it leaves nothing.
class OutputFolder {
 public:
  /// Throws WriteError when the target is there and no folder, or its parent cannot be written.
  explicit OutputFolder(std::filesystem::path target);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write the file that will be `name` in the target.
  [[nodiscard]] std::filesystem::path staged(const std::string& name);
  /// Moves every staged file into the target, replacing files of the same name. Throws WriteError.
  void commit();

 private:
  std::filesystem::path target_, staging_;
  std::vector<std::string> names_;
};

}  // namespace shapelight::cli
