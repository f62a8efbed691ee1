#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "shapelight/core/types.hpp"

namespace shapelight {

enum class ScalarType : std::uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float32, Float64 };

/// Name as in PLY and numpy: "int8" .. "float64".
[[nodiscard]] std::string_view scalar_type_name(ScalarType type);
[[nodiscard]] std::size_t scalar_type_size(ScalarType type);  ///< [bytes]

/// One named scalar per element, in the type of the file, so that writing it back changes no bit.
/// The variant's alternatives are in the order of ScalarType.
struct Column {
  using Values =
      std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                   std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                   std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>, std::vector<double>>;
  std::string name;
  Values values;

  [[nodiscard]] ScalarType type() const { return static_cast<ScalarType>(values.index()); }
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] double as_double(std::size_t i) const;  ///< value i, converted
  [[nodiscard]] std::vector<double> to_doubles() const;
  /// The values at `indices`, in that order. Pre: every index < size().
  [[nodiscard]] Column gather(std::span<const Index> indices) const;
};

/// An empty column of the given type with `count` zeros.
[[nodiscard]] Column make_column(std::string name, ScalarType type, std::size_t count = 0);

/// Named columns of equal length, in file order. Names follow PLY: nx ny nz, red green blue alpha, intensity,
/// classification, gps_time, ...; a name occurs once.
class AttributeTable {
 public:
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] bool empty() const { return columns_.empty(); }
  [[nodiscard]] const Column* find(std::string_view name) const;  ///< nullptr when absent
  [[nodiscard]] Column* find(std::string_view name);
  /// Adds the column, or replaces the one of the same name in its place.
  void set(Column column);
  /// Sets every column of another table.
  void set(AttributeTable columns);
  bool remove(std::string_view name);  ///< false when absent
  [[nodiscard]] AttributeTable gather(std::span<const Index> indices) const;

 private:
  std::vector<Column> columns_;
};

}  // namespace shapelight
