#include "io/text_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "io/scalar_bytes.hpp"

namespace shapelight::io {
namespace {

constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};

// The next wider signed type, which holds every value of the narrower ones; Int64 is the last.
ScalarType wider(ScalarType type) {
  switch (scalar_type_size(type)) {
    case 1:
      return ScalarType::Int16;
    case 2:
      return ScalarType::Int32;
    default:
      return ScalarType::Int64;
  }
}

Column converted(const Column& column, ScalarType type) {
  Column result = make_column(column.name, type, column.size());
  std::visit(
      [&](const auto& from) {
        std::visit(
            [&]<class To>(std::vector<To>& to) {
              std::transform(from.begin(), from.end(), to.begin(), [](auto v) { return static_cast<To>(v); });
            },
            result.values);
      },
      column.values);
  return result;
}

bool is_exact_in_float32(ScalarType type) { return type == ScalarType::Float32 || scalar_type_size(type) <= 2; }

}  // namespace

bool float32_keeps(std::string_view token, double value) {
  const double loss = std::abs(static_cast<double>(static_cast<float>(value)) - value);
  if (!(loss > 0.0)) return true;  // exact, or not finite
  const std::size_t e = std::min(token.find_first_of("eE"), token.size());
  const std::size_t point = std::min(token.find('.'), e);
  const double decimals = point < e ? static_cast<double>(e - point - 1) : 0.0;
  const double exponent = e < token.size() ? parse_double(token.substr(e + 1)).value_or(0.0) : 0.0;
  return loss <= 0.500001 * std::pow(10.0, exponent - decimals);
}

TextColumn::TextColumn(std::string name, ScalarType type, std::size_t expected)
    : declared_(type),
      is_trial_(type == ScalarType::Float32 && std::find(kAxes.begin(), kAxes.end(), name) != kAxes.end()) {
  column_ = make_column(std::move(name), is_trial_ ? ScalarType::Float64 : type);
  std::visit([&](auto& v) { v.reserve(expected); }, column_.values);
}

template <class T>
bool TextColumn::append_integer(std::vector<T>& values, std::string_view token) {
  if (token.starts_with('+')) token.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || end != token.data() + token.size()) {
    const std::optional<double> real = parse_double(token);  // "12.0", which some writers leave in integer columns
    if (!real || *real != std::floor(*real) || std::abs(*real) > 9e15) return false;
    if (*real < static_cast<double>(std::numeric_limits<T>::lowest()) ||
        *real > static_cast<double>(std::numeric_limits<T>::max())) {
      return false;
    }
    value = static_cast<T>(*real);
  }
  values.push_back(value);
  return true;
}

void TextColumn::widen() {
  const std::size_t capacity = std::visit([](const auto& v) { return v.capacity(); }, column_.values);
  column_ = converted(column_, wider(column_.type()));
  std::visit([&](auto& v) { v.reserve(capacity); }, column_.values);
}

void TextColumn::append(const TextScanner& scanner, std::string_view token) {
  if (auto* doubles = std::get_if<std::vector<double>>(&column_.values)) {
    const double value = scanner.need_double(token, column_.name);
    if (is_trial_ && keeps_float32_) keeps_float32_ = float32_keeps(token, value);
    doubles->push_back(value);
    return;
  }
  if (auto* floats = std::get_if<std::vector<float>>(&column_.values)) {
    floats->push_back(static_cast<float>(scanner.need_double(token, column_.name)));
    return;
  }
  for (;;) {
    const bool appended = std::visit(
        [&]<class T>(std::vector<T>& values) {
          if constexpr (std::is_integral_v<T>) return append_integer(values, token);
          return false;
        },
        column_.values);
    if (appended) return;
    const std::optional<double> real = parse_double(token);
    if (scalar_type_size(column_.type()) == 8 || !real || *real != std::floor(*real)) {
      (void)scanner.need_integer(token, column_.name);
      scanner.fail(fmt::format("{} does not fit its type {}", column_.name, scalar_type_name(column_.type())));
    }
    widen();
  }
}

std::vector<Column> TextColumn::finish(std::vector<TextColumn>& columns, std::vector<std::string>& warnings) {
  const bool float32_is_enough =
      std::all_of(columns.begin(), columns.end(), [](const TextColumn& c) { return c.keeps_float32_; });
  if (!float32_is_enough) warnings.emplace_back("coordinates have more digits than float32 holds; read as float64");
  std::vector<Column> finished;
  for (TextColumn& c : columns) {
    if (!c.is_trial_ && c.column_.type() != c.declared_) {
      const std::string_view type = scalar_type_name(c.column_.type());
      warnings.push_back(fmt::format("{} is declared {} but holds values that need {}; read as {}", c.column_.name,
                                     scalar_type_name(c.declared_), type, type));
    }
    const bool narrows = c.is_trial_ && float32_is_enough;
    finished.push_back(narrows ? converted(c.column_, ScalarType::Float32) : std::move(c.column_));
  }
  return finished;
}

bool take_positions(std::vector<Column>& columns, Geometry& geometry) {
  geometry.coordinate_type = ScalarType::Float32;
  for (int axis = 0; axis < 3; ++axis) {
    const auto found =
        std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == kAxes[axis]; });
    if (found == columns.end()) return false;
    if (!is_exact_in_float32(found->type())) geometry.coordinate_type = ScalarType::Float64;
    geometry.positions.resize(found->size());
    std::visit(
        [&](const auto& values) {
          for (std::size_t i = 0; i < values.size(); ++i) geometry.positions[i][axis] = static_cast<double>(values[i]);
        },
        found->values);
    columns.erase(found);
  }
  return true;
}

}  // namespace shapelight::io
