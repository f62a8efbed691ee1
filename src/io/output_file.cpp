#include "io/output_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "shapelight/core/error.hpp"

namespace shapelight::io {

OutputFile::OutputFile(std::filesystem::path target, bool overwrite, const RunContext& context)
    : target_(std::move(target)), context_(context) {
  std::error_code ignored;
  if (std::filesystem::is_directory(target_, ignored)) fail("is a folder");
  if (!overwrite && std::filesystem::exists(target_, ignored))
    fail("exists already, not overwritten (--force allows it)");
  temporary_ = target_;
  temporary_ += fmt::format(".{}.part", ::getpid());
  file_ = std::fopen(temporary_.c_str(), "wbx");
  if (file_ == nullptr) fail(std::generic_category().message(errno));
}

OutputFile::~OutputFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void OutputFile::write(const void* data, std::size_t size) {
  context_.check();
  if (size != 0 && std::fwrite(data, 1, size, file_) != size) fail(std::generic_category().message(errno));
}

void OutputFile::commit() {
  context_.check();
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail(std::generic_category().message(errno));
  std::error_code error;
  std::filesystem::rename(temporary_, target_, error);
  if (error) fail(error.message());
  std::fclose(file_);
  file_ = nullptr;
}

void OutputFile::fail(const std::string& what) const {
  throw WriteError(fmt::format("{}: cannot write: {}", target_.string(), what));
}

}  // namespace shapelight::io
