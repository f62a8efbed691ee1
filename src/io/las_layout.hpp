#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shapelight/data/attributes.hpp"

/// Where things are in LAS files: ASPRS LAS 1.4 R15, which also describes 1.0 to 1.3.
namespace shapelight::io::las {

// Offsets of the public header block. [bytes]
inline constexpr std::size_t kGlobalEncoding = 6, kVersionMinor = 25, kHeaderSize = 94, kPointsOffset = 96,
                             kNumVlrs = 100, kPointFormat = 104, kRecordLength = 105, kLegacyCount = 107,
                             kLegacyReturns = 111, kScale = 131, kOffset = 155, kBounds = 179, kWaveformStart = 227,
                             kEvlrStart = 235, kNumEvlrs = 243, kCount = 247, kReturns = 255;
inline constexpr std::size_t kMinHeaderSize = 227;  ///< versions 1.0 to 1.2
inline constexpr std::size_t kHeaderSize14 = 375;

inline constexpr std::size_t kVlrHeaderSize = 54;         ///< [bytes]
inline constexpr std::size_t kExtraDescriptorSize = 192;  ///< [bytes] of one dimension in the extra bytes record
inline constexpr std::uint16_t kExtraBytesRecord = 4;     ///< of user LASF_Spec

/// One attribute of a point record; X, Y, Z are not listed, they are its first 12 bytes.
struct Field {
  std::string_view name;
  ScalarType type;
  std::uint16_t offset;    ///< [bytes] within the record
  std::uint8_t shift = 0;  ///< [bits] of a bit field within its byte
  std::uint8_t bits = 0;   ///< [bits]; 0: the whole of `type`
};

inline constexpr std::uint8_t kMaxPointFormat = 10;
/// The attributes of a point format, in the order of the record. Pre: point_format <= kMaxPointFormat.
[[nodiscard]] std::vector<Field> point_fields(std::uint8_t point_format);
[[nodiscard]] std::size_t point_size(std::uint8_t point_format);  ///< [bytes] without extra bytes

/// One variable length record.
struct Vlr {
  std::span<const std::byte> whole;  ///< with its header
  std::string_view user_id;
  std::uint16_t record_id = 0;

  [[nodiscard]] std::span<const std::byte> payload() const { return whole.subspan(kVlrHeaderSize); }
  [[nodiscard]] bool is_extra_bytes() const { return user_id == "LASF_Spec" && record_id == kExtraBytesRecord; }
};

/// The record at the start of `bytes`; nothing when it does not fit.
[[nodiscard]] std::optional<Vlr> first_vlr(std::span<const std::byte> bytes);

/// One extra dimension: `components` values of `type` (or undocumented bytes) after the standard record.
struct ExtraDimension {
  std::string name;
  std::optional<ScalarType> type;  ///< nothing: undocumented bytes
  std::size_t components = 1;      ///< values, or bytes when undocumented
  bool is_scaled = false;          ///< carries a scale or offset
  std::span<const std::byte> descriptor;

  [[nodiscard]] std::size_t bytes() const { return components * (type ? scalar_type_size(*type) : 1); }
};

/// The dimensions that an extra bytes record describes; a rest shorter than a descriptor is ignored.
[[nodiscard]] std::vector<ExtraDimension> extra_dimensions(std::span<const std::byte> payload);
/// The code of `type` in a descriptor.
[[nodiscard]] std::uint8_t extra_type_code(ScalarType type);

/// A fixed-size text field up to its first zero byte.
[[nodiscard]] std::string_view fixed_text(std::span<const std::byte> field);

}  // namespace shapelight::io::las
