#include "io/mapped_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "shapelight/core/error.hpp"

namespace shapelight::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw ReadError(fmt::format("{}: cannot read: {}", path.string(), std::generic_category().message(error)));
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail(path, errno);
  struct stat status {};
  const bool known = ::fstat(file, &status) == 0;
  const int stat_error = known ? (S_ISDIR(status.st_mode) ? EISDIR : 0) : errno;
  if (stat_error != 0 || !S_ISREG(status.st_mode)) {
    ::close(file);
    fail(path, stat_error != 0 ? stat_error : ENOTSUP);
  }
  size_ = static_cast<std::size_t>(status.st_size);
  if (size_ > 0) {
    void* mapped = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    const int map_error = errno;
    ::close(file);
    if (mapped == MAP_FAILED) fail(path, map_error);
    data_ = static_cast<const std::byte*>(mapped);
  } else {
    ::close(file);
  }
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

}  // namespace shapelight::io
