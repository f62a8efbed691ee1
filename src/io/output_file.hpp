#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "shapelight/core/run_context.hpp"

namespace shapelight::io {

/// Writes beside the target and renames on commit(), so that the target is either old or complete. Destroyed without
/// commit(), it removes what it wrote. Every failure is a WriteError that names the target. Writers pass their bytes on
/// in blocks of at most about a megabyte; each of them, and commit(), looks for a stop first.
class OutputFile {
 public:
  /// Throws WriteError when the target exists and `overwrite` is off, or its folder cannot be written.
  OutputFile(std::filesystem::path target, bool overwrite, const RunContext& context = {});
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();
  /// Where it writes until then.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

 private:
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::FILE* file_ = nullptr;
  RunContext context_;
};

}  // namespace shapelight::io
