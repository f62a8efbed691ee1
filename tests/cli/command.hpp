#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "io/file_support.hpp"
#include "support/data_files.hpp"

/// The built binary as a process of its own.
namespace shapelight::cli_test {

using Arguments = std::vector<std::string>;

inline std::string data(std::string_view name) { return std::string(SHAPELIGHT_DATA_DIR "/") + std::string(name); }

struct Outcome {
  int code = -1;  ///< exit code; 128 + signal when one ended it
  std::string out, err;
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// A folder that commands write to, beside the files with what they said.
class Workplace {
 public:
  [[nodiscard]] std::string path(std::string_view name) const { return files_ / name; }

  pid_t start(const Arguments& arguments) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    redirect(STDOUT_FILENO, said_ / "out");
    redirect(STDERR_FILENO, said_ / "err");
    std::vector<char*> raw = {const_cast<char*>(SHAPELIGHT_BINARY)};
    for (const std::string& argument : arguments) raw.push_back(const_cast<char*>(argument.c_str()));
    raw.push_back(nullptr);
    ::execv(SHAPELIGHT_BINARY, raw.data());
    ::_exit(127);
  }

  Outcome finish(pid_t child) const {
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), said_out(), said_err()};
  }

  Outcome run(const Arguments& arguments) const { return finish(start(arguments)); }

  [[nodiscard]] std::string said_out() const { return io::test::slurp(said_ / "out"); }
  [[nodiscard]] std::string said_err() const { return io::test::slurp(said_ / "err"); }

  /// Names of all files written so far.
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(files_ / "")) names.insert(entry.path().filename());
    return names;
  }

  std::string write(std::string_view name, std::string_view contents) const { return files_.write(name, contents); }

 private:
  static void redirect(int stream, const std::filesystem::path& file) {
    const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(opened, stream);
    ::close(opened);
  }

  io::test::TempFolder files_, said_;
};

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace shapelight::cli_test
