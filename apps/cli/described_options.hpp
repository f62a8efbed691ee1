#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

#include "shapelight/core/error.hpp"
#include "shapelight/core/options.hpp"
#include "values.hpp"

namespace shapelight::cli {

/// The names of an enum, "a|b|c".
template <class E>
[[nodiscard]] std::string enum_choices() {
  std::string names;
  for (const auto& [value, name] : enum_names(E{})) names += fmt::format("{}{}", names.empty() ? "" : "|", name);
  return names;
}

/// Throws InvalidInput that lists the names.
template <class E>
[[nodiscard]] E parse_enum(std::string_view option, std::string_view text) {
  for (const auto& [value, name] : enum_names(E{})) {
    if (name == text) return value;
  }
  throw InvalidInput(fmt::format("--{}: '{}', expected {}", option, text, enum_choices<E>()));
}

/// Flags made from an options struct's describe() table. What was typed is kept apart, so that a preset can be laid
/// down first and single options override it.
template <DescribedOptions T>
class DescribedFlags {
 public:
  /// Adds one flag per member; `main_names` go to the main help group, all others to "Stage options".
  DescribedFlags(CLI::App& app, std::initializer_list<std::string_view> main_names) {
    T defaults;
    T::describe(defaults, [&](const OptionInfo& info, const auto& member) {
      CLI::Option* option = add(app, info, member);
      const bool is_main = std::find(main_names.begin(), main_names.end(), info.name) != main_names.end();
      option->group(is_main ? "Options" : "Stage options");
    });
  }

  [[nodiscard]] bool was_given(std::string_view name) const { return typed_->count(std::string(name)) > 0; }

  /// Overrides the members that were typed. Lengths may be typed as shares of the diagonal, 2%, and so may shares, 5%.
  /// Throws InvalidInput.
  void apply(T& options, double diagonal = 1.0) const {
    T::describe(options, [&](const OptionInfo& info, auto& member) {
      const auto found = typed_->find(std::string(info.name));
      if (found != typed_->end()) parse(info, found->second, diagonal, member);
    });
  }

 private:
  using Typed = std::map<std::string, std::string>;

  template <class Member>
  CLI::Option* add(CLI::App& app, const OptionInfo& info, const Member& value) {
    const std::string name(info.name);
    if constexpr (std::is_same_v<Member, bool>) {
      return app.add_flag_function(
          fmt::format("--{0},!--no-{0}", name),
          [typed = typed_, name](std::int64_t times) { (*typed)[name] = times > 0 ? "1" : ""; }, help(info, value));
    } else {
      return app
          .add_option_function<std::string>(
              "--" + name, [typed = typed_, name](const std::string& text) { (*typed)[name] = text; },
              help(info, value))
          ->type_name(type_name<Member>());
    }
  }

  template <class Member>
  static std::string type_name() {
    if constexpr (std::is_enum_v<Member>) {
      return enum_choices<Member>();
    } else if constexpr (std::is_integral_v<Member>) {
      return "N";
    } else {
      return "X";
    }
  }

  template <class Member>
  static std::string help(const OptionInfo& info, const Member& value) {
    std::string text(info.meaning);
    if (!info.unit.empty() && info.unit != "1") text += fmt::format(" [{}]", info.unit);
    if constexpr (std::is_same_v<Member, bool>)
      return text + (value ? " (on)" : "");
    else if constexpr (std::is_enum_v<Member>)
      return text + fmt::format(" ({})", enum_name(value));
    else
      return text + fmt::format(" ({:g})", static_cast<double>(value));
  }

  template <class Member>
  static void parse(const OptionInfo& info, const std::string& text, double diagonal, Member& member) {
    if constexpr (std::is_same_v<Member, bool>) {
      member = !text.empty();
    } else if constexpr (std::is_enum_v<Member>) {
      member = parse_enum<Member>(info.name, text);
    } else if (info.unit == "input length unit" && text.ends_with('%')) {
      member = static_cast<Member>(parse_length(info.name, text).resolve(diagonal));
      check_range(info, static_cast<double>(member));
    } else if (info.unit == "1" && std::is_floating_point_v<Member> && text.ends_with('%')) {
      const std::string percents = text.substr(0, text.size() - 1);
      member = static_cast<Member>(parse_number(info.name, percents, "a share such as 0.05 or 5%") / 100.0);
      check_range(info, static_cast<double>(member));
    } else {
      const double value = parse_number(info.name, text, std::is_integral_v<Member> ? "a whole number" : "a number");
      check_range(info, value);
      if (std::is_integral_v<Member> && value != std::floor(value)) {
        throw InvalidInput(fmt::format("--{}: '{}', expected a whole number", info.name, text));
      }
      member = static_cast<Member>(value);
    }
  }

  std::shared_ptr<Typed> typed_ = std::make_shared<Typed>();
};

/// The options as resolved, by name.
template <DescribedOptions T>
[[nodiscard]] nlohmann::ordered_json options_json(const T& options) {
  nlohmann::ordered_json json;
  T::describe(options, [&](const OptionInfo& info, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if constexpr (std::is_enum_v<Member>)
      json[std::string(info.name)] = enum_name(member);
    else
      json[std::string(info.name)] = member;
  });
  return json;
}

}  // namespace shapelight::cli
