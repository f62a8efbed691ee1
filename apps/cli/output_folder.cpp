#include "output_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <system_error>

#include "shapelight/core/error.hpp"

namespace shapelight::cli {
namespace {

void check(const std::error_code& error, const std::filesystem::path& target) {
  if (error) throw WriteError(fmt::format("{}: cannot write: {}", target.string(), error.message()));
}

}  // namespace

OutputFolder::OutputFolder(std::filesystem::path target) : target_(std::move(target)) {
  if (!target_.has_filename()) target_ = target_.parent_path();  // "out/" is "out"
  std::error_code error;
  if (std::filesystem::exists(target_, error) && !std::filesystem::is_directory(target_, error)) {
    throw WriteError(fmt::format("{}: is a file, expected a folder or nothing", target_.string()));
  }
  const std::string mark = fmt::format(".{}.part", ::getpid());
  staging_ = std::filesystem::exists(target_, error) ? target_ / mark : std::filesystem::path(target_) += mark;
  std::filesystem::create_directory(staging_, error);
  check(error, target_);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(staging_, ignored);
}

std::filesystem::path OutputFolder::staged(const std::string& name) {
  names_.push_back(name);
  return staging_ / name;
}

void OutputFolder::commit() {
  std::error_code error;
  if (!std::filesystem::exists(target_, error)) {
    std::filesystem::rename(staging_, target_, error);
    check(error, target_);
    return;
  }
  for (const std::string& name : names_) {
    std::filesystem::rename(staging_ / name, target_ / name, error);
    check(error, target_ / name);
  }
}

}  // namespace shapelight::cli
