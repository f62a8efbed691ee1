#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/poll.hpp"
#include "io/formats.hpp"
#include "io/las_layout.hpp"
#include "io/scalar_bytes.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::io {
namespace {

using namespace las;

constexpr std::size_t kMaxExtraDimensions = 4096;  // far above any real file; bounds the work for a hostile one

class LasReader {
 public:
  explicit LasReader(const Source& source) : source_(source), bytes_(source.file.bytes()) {}

  Geometry read() {
    check_header();
    read_vlrs();
    check_points();
    read_positions();
    for (const Field& field : point_fields(info_.point_format)) geometry_.attributes.set(read_field(field));
    read_extra_bytes();
    if (header_size_ >= kHeaderSize14 && minor_ >= 4 && at<std::uint32_t>(kNumEvlrs) > 0) {
      warn(fmt::format("{} extended variable length records behind the points skipped", at<std::uint32_t>(kNumEvlrs)));
    }
    geometry_.las = std::make_shared<const LasInfo>(std::move(info_));
    return std::move(geometry_);
  }

 private:
  void check_header() {
    if (bytes_.size() < kMinHeaderSize) {
      fail(0, fmt::format("a header of {} bytes expected, the file has {}", kMinHeaderSize, bytes_.size()));
    }
    if (std::string_view(reinterpret_cast<const char*>(bytes_.data()), 4) != "LASF")
      fail(0, "not a LAS file, expected LASF");
    minor_ = at<std::uint8_t>(kVersionMinor);
    if (at<std::uint8_t>(kVersionMinor - 1) != 1 || minor_ > 4) {
      fail(kVersionMinor - 1,
           fmt::format("version {}.{}, expected 1.0 to 1.4", at<std::uint8_t>(kVersionMinor - 1), minor_));
    }
    header_size_ = at<std::uint16_t>(kHeaderSize);
    const std::size_t min_size = minor_ >= 4 ? kHeaderSize14 : kMinHeaderSize;
    points_offset_ = at<std::uint32_t>(kPointsOffset);
    if (header_size_ < min_size || header_size_ > points_offset_ || points_offset_ > bytes_.size()) {
      fail(kHeaderSize,
           fmt::format("a header of {} bytes and points from byte {} on, expected at least {} and at most {}",
                       header_size_, points_offset_, min_size, bytes_.size()));
    }
    const auto format = at<std::uint8_t>(kPointFormat);
    if ((format & 0xC0) != 0)
      fail(kPointFormat, "the points are compressed (LAZ), expected plain LAS; the Python package reads LAZ");
    if (format > kMaxPointFormat)
      fail(kPointFormat, fmt::format("point format {}, expected 0 to {}", format, kMaxPointFormat));
    info_.point_format = format;
    for (int axis = 0; axis < 3; ++axis) {
      info_.scale[axis] = at<double>(kScale + 8 * axis);
      info_.offset[axis] = at<double>(kOffset + 8 * axis);
      if (!std::isfinite(info_.scale[axis]) || info_.scale[axis] == 0.0 || !std::isfinite(info_.offset[axis])) {
        fail(kScale + 8 * axis, "scale or offset of an axis is not usable, expected finite numbers and no scale of 0");
      }
    }
    info_.header.assign(bytes_.begin(), bytes_.begin() + header_size_);
  }

  void read_vlrs() {
    std::span<const std::byte> left = bytes_.subspan(header_size_, points_offset_ - header_size_);
    info_.vlrs.assign(left.begin(), left.end());
    const auto count = at<std::uint32_t>(kNumVlrs);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::optional<Vlr> vlr = first_vlr(left);
      if (!vlr) {
        fail(points_offset_ - left.size(),
             fmt::format("variable length record {} of {} does not end before the points, "
                         "expected at byte {}",
                         i + 1, count, points_offset_));
      }
      if (vlr->is_extra_bytes()) {
        for (ExtraDimension& d : extra_dimensions(vlr->payload())) extra_.push_back(std::move(d));
        if (extra_.size() > kMaxExtraDimensions) {
          fail(points_offset_ - left.size(), fmt::format("more than {} extra dimensions", kMaxExtraDimensions));
        }
      }
      left = left.subspan(vlr->whole.size());
    }
  }

  void check_points() {
    stride_ = at<std::uint16_t>(kRecordLength);
    std::uint64_t count = at<std::uint32_t>(kLegacyCount);
    if (minor_ >= 4 && at<std::uint64_t>(kCount) != 0) count = at<std::uint64_t>(kCount);
    const std::size_t size = point_size(info_.point_format);
    if (stride_ < size) {
      fail(kRecordLength, fmt::format("records of {} bytes, expected at least {} for point format {}", stride_, size,
                                      info_.point_format));
    }
    if (count == 0) fail(kLegacyCount, "0 points, expected at least one");
    if (count > kMaxPoints) fail(kLegacyCount, fmt::format("{} points, expected at most {}", count, kMaxPoints));
    const std::size_t left = bytes_.size() - points_offset_;
    if (count > left / stride_) {
      fail(points_offset_, fmt::format("{} points of {} bytes expected, {} bytes left", count, stride_, left));
    }
    count_ = count;
  }

  void read_positions() {
    geometry_.positions.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      poll(source_.context, i);
      for (int axis = 0; axis < 3; ++axis) {
        const auto raw = load<std::int32_t>(point(i) + 4 * axis);
        geometry_.positions[i][axis] = raw * info_.scale[axis] + info_.offset[axis];
      }
    }
  }

  Column read_field(const Field& field) const {
    source_.context.check();
    Column column = load_column(std::string(field.name), field.type, point(0) + field.offset, stride_, count_);
    if (field.bits != 0) {
      const auto mask = static_cast<std::uint8_t>((1u << field.bits) - 1u);
      for (std::uint8_t& v : std::get<std::vector<std::uint8_t>>(column.values)) {
        v = static_cast<std::uint8_t>(v >> field.shift & mask);
      }
    }
    return column;
  }

  // Values stay as stored, without the optional scale, so that they can be written back.
  void read_extra_bytes() {
    std::size_t offset = point_size(info_.point_format);
    for (const ExtraDimension& d : extra_) {
      if (d.bytes() > stride_ - offset) {
        fail(kRecordLength,
             fmt::format("extra dimensions need {} bytes per point, expected at most {}", offset + d.bytes(), stride_));
      }
      if (d.type && !d.name.empty()) {
        for (std::size_t k = 0; k < d.components; ++k) read_extra(d, k, offset + k * scalar_type_size(*d.type));
        if (d.is_scaled)
          warn(fmt::format("extra dimension {} has a scale or offset; its stored values are kept", d.name));
      } else {
        num_unknown_bytes_ += d.bytes();
      }
      offset += d.bytes();
    }
    num_unknown_bytes_ += stride_ - offset;
    if (num_unknown_bytes_ > 0) warn(fmt::format("{} undocumented bytes per point skipped", num_unknown_bytes_));
  }

  void read_extra(const ExtraDimension& d, std::size_t component, std::size_t offset) {
    source_.context.check();
    const std::string name = d.components == 1 ? d.name : fmt::format("{}_{}", d.name, component);
    if (geometry_.attributes.find(name) != nullptr) {
      warn(fmt::format("extra dimension {} has the name of another attribute, skipped", name));
      return;
    }
    geometry_.attributes.set(load_column(name, *d.type, point(0) + offset, stride_, count_));
  }

  template <class T>
  [[nodiscard]] T at(std::size_t offset) const {
    return load<T>(bytes_.data() + offset);
  }
  [[nodiscard]] const std::byte* point(std::size_t i) const { return bytes_.data() + points_offset_ + i * stride_; }
  void warn(std::string text) { geometry_.warnings.push_back(std::move(text)); }
  [[noreturn]] void fail(std::size_t offset, const std::string& what) const {
    throw FormatError(fmt::format("las: {}: byte {}: {}", source_.path.string(), offset, what));
  }

  const Source& source_;
  std::span<const std::byte> bytes_;
  std::uint8_t minor_ = 0;
  std::size_t header_size_ = 0;
  std::size_t points_offset_ = 0;
  std::size_t stride_ = 0;
  std::size_t count_ = 0;
  std::size_t num_unknown_bytes_ = 0;
  std::vector<ExtraDimension> extra_;
  LasInfo info_;
  Geometry geometry_;
};

}  // namespace

Geometry read_las(const Source& source) { return LasReader(source).read(); }

}  // namespace shapelight::io
