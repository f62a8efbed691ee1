#include "io/las_layout.hpp"

#include <algorithm>
#include <array>

#include "io/scalar_bytes.hpp"

namespace shapelight::io::las {
namespace {

using enum ScalarType;

// Offsets of the optional parts within the record, 0 where a point format lacks them.
struct Parts {
  std::uint16_t size, gps_time, rgb, nir, wave;
};
constexpr std::array<Parts, kMaxPointFormat + 1> kParts = {{{20, 0, 0, 0, 0},
                                                            {28, 20, 0, 0, 0},
                                                            {26, 0, 20, 0, 0},
                                                            {34, 20, 28, 0, 0},
                                                            {57, 20, 0, 0, 28},
                                                            {63, 20, 28, 0, 34},
                                                            {30, 22, 0, 0, 0},
                                                            {36, 22, 30, 0, 0},
                                                            {38, 22, 30, 36, 0},
                                                            {59, 22, 0, 0, 30},
                                                            {67, 22, 30, 36, 38}}};

// Formats 0 to 5.
constexpr std::array<Field, 12> kOldCore = {{{"intensity", UInt16, 12},
                                             {"return_number", UInt8, 14, 0, 3},
                                             {"number_of_returns", UInt8, 14, 3, 3},
                                             {"scan_direction_flag", UInt8, 14, 6, 1},
                                             {"edge_of_flight_line", UInt8, 14, 7, 1},
                                             {"classification", UInt8, 15, 0, 5},
                                             {"synthetic", UInt8, 15, 5, 1},
                                             {"keypoint", UInt8, 15, 6, 1},
                                             {"withheld", UInt8, 15, 7, 1},
                                             {"scan_angle", Int8, 16},
                                             {"user_data", UInt8, 17},
                                             {"point_source_id", UInt16, 18}}};

// Formats 6 to 10.
constexpr std::array<Field, 14> kNewCore = {{{"intensity", UInt16, 12},
                                             {"return_number", UInt8, 14, 0, 4},
                                             {"number_of_returns", UInt8, 14, 4, 4},
                                             {"synthetic", UInt8, 15, 0, 1},
                                             {"keypoint", UInt8, 15, 1, 1},
                                             {"withheld", UInt8, 15, 2, 1},
                                             {"overlap", UInt8, 15, 3, 1},
                                             {"scanner_channel", UInt8, 15, 4, 2},
                                             {"scan_direction_flag", UInt8, 15, 6, 1},
                                             {"edge_of_flight_line", UInt8, 15, 7, 1},
                                             {"classification", UInt8, 16},
                                             {"user_data", UInt8, 17},
                                             {"scan_angle", Int16, 18},
                                             {"point_source_id", UInt16, 20}}};

// Offsets relative to the wave packet.
constexpr std::array<Field, 7> kWave = {{{"wave_packet_index", UInt8, 0},
                                         {"wave_packet_offset", UInt64, 1},
                                         {"wave_packet_size", UInt32, 9},
                                         {"return_point_location", Float32, 13},
                                         {"wave_dx", Float32, 17},
                                         {"wave_dy", Float32, 21},
                                         {"wave_dz", Float32, 25}}};

// Codes 1 to 10 of extra bytes; 11 to 20 and 21 to 30 are pairs and triples of them.
constexpr std::array<ScalarType, 10> kExtraTypes = {UInt8, Int8,   UInt16, Int16,   UInt32,
                                                    Int32, UInt64, Int64,  Float32, Float64};

}  // namespace

std::vector<Field> point_fields(std::uint8_t point_format) {
  const Parts& parts = kParts[point_format];
  std::vector<Field> fields;
  if (point_format < 6) {
    fields.assign(kOldCore.begin(), kOldCore.end());
  } else {
    fields.assign(kNewCore.begin(), kNewCore.end());
  }
  const auto at = [](std::size_t offset) { return static_cast<std::uint16_t>(offset); };
  if (parts.gps_time != 0) fields.push_back({"gps_time", Float64, parts.gps_time});
  if (parts.rgb != 0) {
    fields.push_back({"red", UInt16, parts.rgb});
    fields.push_back({"green", UInt16, at(parts.rgb + 2u)});
    fields.push_back({"blue", UInt16, at(parts.rgb + 4u)});
  }
  if (parts.nir != 0) fields.push_back({"nir", UInt16, parts.nir});
  if (parts.wave != 0) {
    for (Field field : kWave) {
      field.offset = at(field.offset + std::size_t{parts.wave});
      fields.push_back(field);
    }
  }
  return fields;
}

std::size_t point_size(std::uint8_t point_format) { return kParts[point_format].size; }

std::string_view fixed_text(std::span<const std::byte> field) {
  const auto end = std::find(field.begin(), field.end(), std::byte{0});
  return {reinterpret_cast<const char*>(field.data()), static_cast<std::size_t>(end - field.begin())};
}

std::optional<Vlr> first_vlr(std::span<const std::byte> bytes) {
  if (bytes.size() < kVlrHeaderSize) return std::nullopt;
  const std::size_t size = kVlrHeaderSize + load<std::uint16_t>(bytes.data() + 20);
  if (bytes.size() < size) return std::nullopt;
  return Vlr{bytes.first(size), fixed_text(bytes.subspan(2, 16)), load<std::uint16_t>(bytes.data() + 18)};
}

std::vector<ExtraDimension> extra_dimensions(std::span<const std::byte> payload) {
  std::vector<ExtraDimension> dimensions;
  for (; payload.size() >= kExtraDescriptorSize; payload = payload.subspan(kExtraDescriptorSize)) {
    ExtraDimension d;
    d.descriptor = payload.first(kExtraDescriptorSize);
    d.name = fixed_text(d.descriptor.subspan(4, 32));
    const auto code = load<std::uint8_t>(d.descriptor.data() + 2);
    const auto options = load<std::uint8_t>(d.descriptor.data() + 3);
    if (code >= 1 && code <= 30) {
      d.type = kExtraTypes[(code - 1u) % 10];
      d.components = 1 + (code - 1u) / 10;
      d.is_scaled = (options & 0x18) != 0;
    } else {
      d.components = options;
    }
    dimensions.push_back(std::move(d));
  }
  return dimensions;
}

std::uint8_t extra_type_code(ScalarType type) {
  return static_cast<std::uint8_t>(std::find(kExtraTypes.begin(), kExtraTypes.end(), type) - kExtraTypes.begin() + 1);
}

}  // namespace shapelight::io::las
