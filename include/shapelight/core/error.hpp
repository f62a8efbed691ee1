#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace shapelight {

/// Base of everything the library throws. Messages say where, what, and what was expected.
class Error : public std::runtime_error {
 public:
  /// Process exit code of the command line for this cause; INTERFACE: 1 to 8, 130.
  [[nodiscard]] int exit_code() const noexcept { return exit_code_; }

 protected:
  Error(int exit_code, const std::string& what) : std::runtime_error(what), exit_code_(exit_code) {}

 private:
  int exit_code_;
};

/// An argument or option that the caller could have avoided (exit code 2).
class InvalidInput : public Error {
 public:
  explicit InvalidInput(const std::string& what) : Error(2, what) {}
};

/// The input is missing or cannot be read (exit code 3).
class ReadError : public Error {
 public:
  explicit ReadError(const std::string& what) : Error(3, what) {}
};

/// The input's contents are malformed or unsupported; the message names the place (exit code 4).
class FormatError : public Error {
 public:
  explicit FormatError(const std::string& what) : Error(4, what) {}
};

/// What was asked for cannot be reached; the message says how far it got (exit code 5).
class TargetUnreachable : public Error {
 public:
  TargetUnreachable(const std::string& what, std::uint64_t reachable) : Error(5, what), reachable_(reachable) {}
  /// The most that can be reached, in the unit of the target.
  [[nodiscard]] std::uint64_t reachable() const noexcept { return reachable_; }

 private:
  std::uint64_t reachable_;
};

/// A result does not hold what is promised of it, so it is withheld; the message names the promise (exit code 6).
class PostconditionFailed : public Error {
 public:
  explicit PostconditionFailed(const std::string& what) : Error(6, what) {}
};

/// The memory budget would be exceeded; thrown before work starts (exit code 7).
class BudgetExceeded : public Error {
 public:
  explicit BudgetExceeded(const std::string& what) : Error(7, what) {}
};

/// The output cannot be written; nothing half-written is left (exit code 8).
class WriteError : public Error {
 public:
  explicit WriteError(const std::string& what) : Error(8, what) {}
};

/// A stop was requested through RunContext::stop (exit code 130).
class Cancelled : public Error {
 public:
  Cancelled() : Error(130, "cancelled") {}
};

}  // namespace shapelight
