#include <fmt/format.h>
#include <lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "core/poll.hpp"
#include "io/formats.hpp"
#include "io/pcd_header.hpp"
#include "io/scalar_bytes.hpp"
#include "io/text_columns.hpp"
#include "shapelight/core/error.hpp"

// The Point Cloud Library's own format, versions 0.5 to 0.7.
namespace shapelight::io {
namespace {

// A reference of LZF takes 3 bytes and stands for 264 at most.
constexpr std::uint64_t kMaxLzfRatio = 88;

bool is_packed_color(const PcdField& field) {
  return (field.name == "rgb" || field.name == "rgba") && scalar_type_size(field.type) == 4 && field.count == 1;
}

std::string value_name(const PcdField& field, std::size_t k) {
  return field.count == 1 ? field.name : fmt::format("{}_{}", field.name, k);
}

class PcdReader {
 public:
  explicit PcdReader(const Source& source)
      : source_(source),
        scanner_(source.file.text(), "pcd", source.path.string()),
        header_(read_pcd_header(scanner_)),
        body_(source.file.bytes().subspan(scanner_.byte_offset())) {}

  Geometry read() {
    switch (header_.encoding) {
      case PcdEncoding::Ascii:
        read_ascii();
        break;
      case PcdEncoding::Binary:
        read_binary();
        break;
      case PcdEncoding::Compressed:
        read_compressed();
        break;
    }
    if (!take_positions(columns_, geometry_)) fail("FIELDS lack x, y or z");
    for (Column& column : columns_) set_attribute(std::move(column));
    if (header_.height > 1) set_grid();
    set_viewpoint();
    geometry_.comments.insert(geometry_.comments.begin(), header_.comments.begin(), header_.comments.end());
    return std::move(geometry_);
  }

 private:
  void read_ascii() {
    const std::uint64_t values = header_.values_per_point();
    if (header_.points > (body_.size() + 1) / (2 * values)) {
      fail(fmt::format("{} points of {} values expected, only {} bytes left", header_.points, values, body_.size()));
    }
    std::vector<TextColumn> columns;
    std::vector<std::uint8_t> is_padding;
    for (const PcdField& field : header_.fields) {
      is_padding.insert(is_padding.end(), field.count, field.is_padding());
      for (std::size_t k = 0; k < field.count && !field.is_padding(); ++k) {
        columns.emplace_back(value_name(field, k), field.type, header_.points);
      }
    }
    bool has_long_rows = false;
    for (std::uint64_t i = 0; i < header_.points; ++i) {
      poll(source_.context, i);
      next_row(i);
      auto column = columns.begin();
      for (std::size_t v = 0; v < values; ++v) {
        const std::string_view token = scanner_.next_token(',');
        if (token.empty()) scanner_.fail(fmt::format("point {}: {} values, expected {}", i, v, values));
        if (is_padding[v] == 0) (column++)->append(scanner_, token);
      }
      has_long_rows |= !scanner_.next_token(',').empty();
    }
    if (has_long_rows) geometry_.warnings.emplace_back("rows hold more values than FIELDS, ignored");
    columns_ = TextColumn::finish(columns, geometry_.warnings);
  }

  void next_row(std::uint64_t point) {
    for (;;) {
      const std::optional<std::string_view> line = scanner_.next_line();
      if (!line) scanner_.fail(fmt::format("the file ends, expected point {} of {}", point, header_.points));
      if (line->find_first_not_of(" \t,") != std::string_view::npos && !line->starts_with('#')) return;
    }
  }

  // Point by point.
  void read_binary() {
    const std::size_t stride = header_.bytes_per_point();
    if (header_.points > body_.size() / stride) {
      fail(fmt::format("byte {}: {} points of {} bytes expected, {} bytes left", scanner_.byte_offset(), header_.points,
                       stride, body_.size()));
    }
    std::size_t offset = 0;
    for (const PcdField& field : header_.fields) {
      load_field(field, body_.data() + offset, stride, scalar_type_size(field.type));
      offset += field.bytes();
    }
  }

  // Field by field, compressed as a whole.
  void read_compressed() {
    if (body_.size() < 8) fail(fmt::format("byte {}: two sizes expected, the file ends", scanner_.byte_offset()));
    const std::uint64_t packed = load<std::uint32_t>(body_.data());
    const std::uint64_t unpacked = load<std::uint32_t>(body_.data() + 4);
    const std::uint64_t wanted = header_.points * header_.bytes_per_point();
    if (packed > body_.size() - 8) {
      fail(fmt::format("byte {}: {} compressed bytes expected, {} left", scanner_.byte_offset(), packed,
                       body_.size() - 8));
    }
    if (unpacked != wanted || unpacked > packed * kMaxLzfRatio) {
      fail(fmt::format("byte {}: {} bytes in {} compressed ones, expected {} for {} points", scanner_.byte_offset(),
                       unpacked, packed, wanted, header_.points));
    }
    std::vector<std::byte> data(unpacked);
    const unsigned size =
        lzf_decompress(body_.data() + 8, static_cast<unsigned>(packed), data.data(), static_cast<unsigned>(unpacked));
    if (size != unpacked) fail(fmt::format("the compressed data is damaged, expected {} bytes from it", unpacked));
    const std::byte* first = data.data();
    for (const PcdField& field : header_.fields) {
      load_field(field, first, field.bytes(), scalar_type_size(field.type));
      first += header_.points * field.bytes();
    }
  }

  void load_field(const PcdField& field, const std::byte* first, std::size_t stride, std::size_t size) {
    source_.context.check();
    if (field.is_padding()) return;
    for (std::size_t k = 0; k < field.count; ++k) {
      columns_.push_back(load_column(value_name(field, k), field.type, first + k * size, stride, header_.points));
    }
  }

  void set_attribute(Column column) {
    const auto packed = [&](const PcdField& f) { return f.name == column.name && is_packed_color(f); };
    if (std::any_of(header_.fields.begin(), header_.fields.end(), packed)) {
      unpack_color(column);
    } else if (geometry_.attributes.find(column.name) != nullptr) {
      fail(fmt::format("two fields give the column {}, expected unique names", column.name));
    } else {
      geometry_.attributes.set(std::move(column));
    }
  }

  // 0xAARRGGBB, declared as an integer or as the float of the same bits.
  void unpack_color(const Column& packed) {
    static constexpr std::array<std::pair<const char*, int>, 4> kChannels = {
        {{"red", 16}, {"green", 8}, {"blue", 0}, {"alpha", 24}}};
    const std::size_t num_channels = packed.name == "rgba" ? 4 : 3;
    std::vector<std::uint32_t> bits(packed.size());
    std::visit(
        [&]<class T>(const std::vector<T>& values) {
          std::transform(values.begin(), values.end(), bits.begin(), [](T value) {
            if constexpr (std::is_same_v<T, float>) return std::bit_cast<std::uint32_t>(value);
            return static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
          });
        },
        packed.values);
    for (std::size_t c = 0; c < num_channels; ++c) {
      std::vector<std::uint8_t> channel(bits.size());
      std::transform(bits.begin(), bits.end(), channel.begin(),
                     [shift = kChannels[c].second](std::uint32_t b) { return static_cast<std::uint8_t>(b >> shift); });
      geometry_.attributes.set({kChannels[c].first, std::move(channel)});
    }
  }

  void set_grid() {
    RangeGrid grid{static_cast<std::uint32_t>(header_.width), static_cast<std::uint32_t>(header_.height), {}};
    grid.pixel.resize(geometry_.size());
    std::iota(grid.pixel.begin(), grid.pixel.end(), Index{0});
    geometry_.grid = std::move(grid);
  }

  // The rotation says how the sensor stood; nothing here uses it, so it travels as a comment.
  void set_viewpoint() {
    const auto& v = header_.viewpoint;
    if (v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0) geometry_.viewpoint = Vec3(v.data());
    if (v[4] != 0.0 || v[5] != 0.0 || v[6] != 0.0) {
      geometry_.comments.push_back(fmt::format("viewpoint_quaternion {} {} {} {}", v[3], v[4], v[5], v[6]));
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(fmt::format("pcd: {}: {}", source_.path.string(), what));
  }

  const Source& source_;
  TextScanner scanner_;
  PcdHeader header_;
  std::span<const std::byte> body_;
  std::vector<Column> columns_;
  Geometry geometry_;
};

}  // namespace

Geometry read_pcd(const Source& source) { return PcdReader(source).read(); }

}  // namespace shapelight::io
