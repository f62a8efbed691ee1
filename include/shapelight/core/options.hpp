#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>

namespace shapelight {

/// One option, declared once. Command line flags, JSON keys, validation and the tables in docs all come from it.
struct OptionInfo {
  std::string_view name;     ///< kebab-case, as on the command line
  std::string_view unit;     ///< "1", "rings", "points", "mean edge lengths", "input length units"
  std::string_view meaning;  ///< one sentence
  double min = 0.0;          ///< smallest allowed number
  double max = 0.0;          ///< largest allowed number; numbers only
};

/// An options struct: `static void describe(Self& self, Visitor&& visit)` calls visit(OptionInfo, member) for
/// every member, in the order of declaration. Members are bool, an integer, double, or an enum that has
/// `enum_names(E)` returning an array of (value, name) pairs, found by argument-dependent lookup.
template <class T>
concept DescribedOptions = requires(T& options) {
  T::describe(options, [](const OptionInfo&, auto&) {});
};

/// Name of an enum value from its enum_names() table.
template <class E>
requires std::is_enum_v<E>
[[nodiscard]] std::string_view enum_name(E value) {
  for (const auto& [candidate, name] : enum_names(value)) {
    if (candidate == value) return name;
  }
  return "?";
}

/// Throws InvalidInput: "--name: value, expected min .. max [unit]".
void check_range(const OptionInfo& info, double value);

/// Checks every number of an options struct against its declared range. Throws InvalidInput.
template <DescribedOptions T>
void validate_options(const T& options) {
  T::describe(options, [](const OptionInfo& info, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if constexpr (std::is_arithmetic_v<Member> && !std::same_as<Member, bool>) {
      check_range(info, static_cast<double>(member));
    }
  });
}

}  // namespace shapelight
