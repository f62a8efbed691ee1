#pragma once

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "shapelight/core/error.hpp"
#include "shapelight/core/options.hpp"

/// Keyword arguments from the same tables as command line flags: "local-weight" is local_weight here.
namespace shapelight::python {

namespace nb = nanobind;

[[nodiscard]] std::string keyword_of(const OptionInfo& info);

/// Throws InvalidInput: what was expected of the option.
[[noreturn]] void refuse(const OptionInfo& info, nb::handle value, std::string_view expected);

template <class Member>
void set_option(const OptionInfo& info, nb::handle value, Member& member) {
  if constexpr (std::is_same_v<Member, bool>) {
    if (!nb::try_cast<bool>(value, member)) refuse(info, value, "True or False");
  } else if constexpr (std::is_enum_v<Member>) {
    std::string names, given;
    const bool is_text = nb::try_cast<std::string>(value, given);
    for (const auto& [candidate, name] : enum_names(Member{})) {
      if (is_text && name == given) {
        member = candidate;
        return;
      }
      names += fmt::format("{}'{}'", names.empty() ? "" : ", ", name);
    }
    refuse(info, value, "one of " + names);
  } else if constexpr (std::is_same_v<Member, std::uint64_t>) {
    if (!nb::try_cast<std::uint64_t>(value, member)) refuse(info, value, "a whole number, 0 or more");
  } else {
    double number = 0.0;
    if (!nb::try_cast<double>(value, number)) refuse(info, value, "a number");
    check_range(info, number);
    if (std::is_integral_v<Member> && number != std::floor(number)) refuse(info, value, "a whole number");
    member = static_cast<Member>(number);
  }
}

/// The enum value of this name. Throws InvalidInput that lists the names.
template <class E>
[[nodiscard]] E enum_named(const char* option, const std::string& name) {
  E value{};
  set_option(OptionInfo{option, "", ""}, nb::str(name.c_str()), value);
  return value;
}

/// Overrides the members that `given` names. Throws InvalidInput, and TypeError for a name that no member has.
template <DescribedOptions T>
void apply_options(T& options, const nb::dict& given) {
  std::size_t used = 0;
  T::describe(options, [&](const OptionInfo& info, auto& member) {
    const std::string keyword = keyword_of(info);
    if (!given.contains(keyword.c_str())) return;
    set_option(info, given[keyword.c_str()], member);
    ++used;
  });
  if (used == given.size()) return;
  for (const auto& [name, value] : given) {
    bool known = false;
    T::describe(options,
                [&](const OptionInfo& info, auto&) { known |= nb::cast<std::string>(name) == keyword_of(info); });
    if (!known) throw nb::type_error(("unknown option: " + nb::cast<std::string>(name)).c_str());
  }
}

/// The options of a function that has no presets.
template <DescribedOptions T>
[[nodiscard]] T make_options(const nb::dict& given) {
  T options;
  apply_options(options, given);
  return options;
}

/// One row of a table: what signatures, documentation and stubs are made from.
void add_option_row(nb::list& table, const OptionInfo& info, nb::object type, nb::object default_value,
                    nb::object choices);

/// Makes the options of `function` known as module.option_tables[function].
template <DescribedOptions T>
void publish_options(nb::module_& module, const char* function, T defaults = {}) {
  nb::list table;
  T::describe(defaults, [&](const OptionInfo& info, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if constexpr (std::is_enum_v<Member>) {
      nb::list names;
      for (const auto& [value, name] : enum_names(Member{})) names.append(std::string(name));
      add_option_row(table, info, nb::str("str"), nb::cast(std::string(enum_name(member))), names);
    } else {
      const char* type = std::is_same_v<Member, bool> ? "bool" : std::is_integral_v<Member> ? "int" : "float";
      add_option_row(table, info, nb::str(type), nb::cast(member), nb::none());
    }
  });
  nb::cast<nb::dict>(module.attr("option_tables"))[function] = table;
}

}  // namespace shapelight::python
