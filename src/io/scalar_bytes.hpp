#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "shapelight/data/attributes.hpp"

/// Numbers in raw bytes, of either byte order and any alignment.
namespace shapelight::io {

template <class T>
[[nodiscard]] T swap_bytes(T value) {
  if constexpr (sizeof(T) == 1) {
    return value;
  } else if constexpr (sizeof(T) == 2) {
    return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<std::uint16_t>(value)));
  } else if constexpr (sizeof(T) == 4) {
    return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
  } else {
    return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<std::uint64_t>(value)));
  }
}

/// The number at `from`, stored in byte order `order`. Pre: sizeof(T) bytes are there.
template <class T>
[[nodiscard]] T load(const std::byte* from, std::endian order = std::endian::little) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return order == std::endian::native ? value : swap_bytes(value);
}

/// Stores in little endian. Pre: sizeof(T) bytes are there.
template <class T>
void store(std::byte* to, T value) {
  if constexpr (std::endian::native != std::endian::little) value = swap_bytes(value);
  std::memcpy(to, &value, sizeof(T));
}

/// Appends in little endian.
template <class T>
void append_bytes(std::string& out, T value) {
  if constexpr (std::endian::native != std::endian::little) value = swap_bytes(value);
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// Calls body(T{}) with the C++ type that `type` stands for.
template <class Body>
decltype(auto) with_type(ScalarType type, Body&& body) {
  switch (type) {
    case ScalarType::Int8:
      return body(std::int8_t{});
    case ScalarType::UInt8:
      return body(std::uint8_t{});
    case ScalarType::Int16:
      return body(std::int16_t{});
    case ScalarType::UInt16:
      return body(std::uint16_t{});
    case ScalarType::Int32:
      return body(std::int32_t{});
    case ScalarType::UInt32:
      return body(std::uint32_t{});
    case ScalarType::Int64:
      return body(std::int64_t{});
    case ScalarType::UInt64:
      return body(std::uint64_t{});
    case ScalarType::Float32:
      return body(float{});
    case ScalarType::Float64:
      break;
  }
  return body(double{});
}

[[nodiscard]] inline bool is_float(ScalarType type) {
  return type == ScalarType::Float32 || type == ScalarType::Float64;
}

/// A column of `count` numbers that lie `stride` bytes apart. Pre: all of them are there.
[[nodiscard]] inline Column load_column(std::string name, ScalarType type, const std::byte* first, std::size_t stride,
                                        std::size_t count, std::endian order = std::endian::little) {
  Column column = make_column(std::move(name), type, count);
  std::visit(
      [&]<class T>(std::vector<T>& values) {
        for (std::size_t i = 0; i < count; ++i) values[i] = load<T>(first + i * stride, order);
      },
      column.values);
  return column;
}

}  // namespace shapelight::io
