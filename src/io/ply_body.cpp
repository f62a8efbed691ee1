#include "io/ply_body.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "core/poll.hpp"
#include "io/scalar_bytes.hpp"
#include "io/text_columns.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::io {
namespace {

enum class Use : std::uint8_t { Scalar, Indices, Texcoords, Skipped };

Use use_of(const PlyProperty& property) {
  if (!property.list_count_type) return Use::Scalar;
  if (property.name == "vertex_indices" || property.name == "vertex_index") return Use::Indices;
  return property.name == "texcoord" ? Use::Texcoords : Use::Skipped;
}

std::vector<Use> uses_of(const PlyElement& element, PlyRows& rows, std::vector<std::string>& warnings) {
  std::vector<Use> uses;
  for (const PlyProperty& property : element.properties) {
    Use use = use_of(property);
    if (use == Use::Indices && std::exchange(rows.has_indices, true)) use = Use::Skipped;
    if (use == Use::Skipped)
      warnings.push_back(fmt::format("list {} of element {} skipped", property.name, element.name));
    uses.push_back(use);
  }
  return uses;
}

// -1 is kNoIndex, which also fails every range check; so do indices that are too large.
std::optional<Index> to_index(double value) {
  if (value == -1.0) return kNoIndex;
  if (!(value >= 0.0) || value > static_cast<double>(kNoIndex) || value != std::floor(value)) return std::nullopt;
  return static_cast<Index>(value);
}

class BinaryBody final : public PlyBody {
 public:
  BinaryBody(const Source& source, const PlyHeader& header)
      : source_(source), order_(header.order), bytes_(source.file.bytes()), position_(header.body_offset) {}

  PlyRows read(const PlyElement& element, std::vector<std::string>& warnings) override {
    element_ = &element;
    check_count();
    return element.has_lists() ? read_rows(warnings) : read_table();
  }

  void skip(const PlyElement& element) override {
    element_ = &element;
    check_count();
    if (!element.has_lists()) {
      position_ += element.count * element.min_row_bytes();
      return;
    }
    for (row_ = 0; row_ < element.count; ++row_) {
      poll(source_.context, row_);
      for (const PlyProperty& property : element.properties) {
        const std::uint64_t items = property.list_count_type ? read_count(property) : 1;
        (void)take(items, scalar_type_size(property.type), property);
      }
    }
  }

 private:
  // Rows of fixed size: column by column.
  PlyRows read_table() {
    PlyRows rows;
    const std::size_t stride = element_->min_row_bytes();
    const std::byte* first = bytes_.data() + position_;
    for (const PlyProperty& property : element_->properties) {
      source_.context.check();
      rows.columns.push_back(load_column(property.name, property.type, first, stride, element_->count, order_));
      first += scalar_type_size(property.type);
    }
    position_ += element_->count * stride;
    return rows;
  }

  PlyRows read_rows(std::vector<std::string>& warnings) {
    PlyRows rows;
    const std::vector<Use> uses = uses_of(*element_, rows, warnings);
    for (std::size_t p = 0; p < uses.size(); ++p) {
      const PlyProperty& property = element_->properties[p];
      if (uses[p] == Use::Scalar) rows.columns.push_back(make_column(property.name, property.type, element_->count));
    }
    for (row_ = 0; row_ < element_->count; ++row_) {
      poll(source_.context, row_);
      std::size_t column = 0;
      for (std::size_t p = 0; p < uses.size(); ++p) {
        const PlyProperty& property = element_->properties[p];
        switch (uses[p]) {
          case Use::Scalar:
            read_scalar(property, rows.columns[column++]);
            break;
          case Use::Indices:
            read_indices(property, rows.indices);
            break;
          case Use::Texcoords:
            read_texcoords(property, rows.texcoords);
            break;
          case Use::Skipped:
            (void)take(read_count(property), scalar_type_size(property.type), property);
            break;
        }
      }
    }
    return rows;
  }

  void read_scalar(const PlyProperty& property, Column& column) {
    const std::byte* from = take(1, scalar_type_size(property.type), property);
    std::visit([&]<class T>(std::vector<T>& values) { values[row_] = load<T>(from, order_); }, column.values);
  }

  void read_indices(const PlyProperty& property, RowLists<Index>& lists) {
    const std::uint64_t count = read_count(property);
    const std::size_t size = scalar_type_size(property.type);
    const std::byte* from = take(count, size, property);
    for (std::uint64_t i = 0; i < count; ++i) {
      const double value = load_double(property.type, from + i * size);
      const std::optional<Index> index = to_index(value);
      if (!index) fail(property, fmt::format("{} is no vertex index", value));
      lists.items.push_back(*index);
    }
    lists.ends.push_back(lists.items.size());
  }

  void read_texcoords(const PlyProperty& property, RowLists<float>& lists) {
    const std::uint64_t count = read_count(property);
    const std::size_t size = scalar_type_size(property.type);
    const std::byte* from = take(count, size, property);
    for (std::uint64_t i = 0; i < count; ++i) {
      lists.items.push_back(static_cast<float>(load_double(property.type, from + i * size)));
    }
    lists.ends.push_back(lists.items.size());
  }

  std::uint64_t read_count(const PlyProperty& property) {
    const ScalarType type = *property.list_count_type;
    const double count = load_double(type, take(1, scalar_type_size(type), property));
    if (!(count >= 0.0) || count > static_cast<double>(bytes_.size())) {
      fail(property, fmt::format("a list of {} items in a file of {} bytes", count, bytes_.size()));
    }
    return static_cast<std::uint64_t>(count);
  }

  [[nodiscard]] double load_double(ScalarType type, const std::byte* from) const {
    return with_type(type, [&]<class T>(T) { return static_cast<double>(load<T>(from, order_)); });
  }

  // The next `count` items of `size` bytes; count is at most the number of bytes in the file.
  const std::byte* take(std::uint64_t count, std::size_t size, const PlyProperty& property) {
    if (count * size > bytes_.size() - position_) {
      fail(property, fmt::format("{} bytes expected, {} left", count * size, bytes_.size() - position_));
    }
    return bytes_.data() + std::exchange(position_, position_ + count * size);
  }

  void check_count() const {
    const std::size_t row = element_->min_row_bytes();
    const std::size_t left = bytes_.size() - position_;
    if (row != 0 && element_->count > left / row) {
      throw FormatError(fmt::format("ply: {}: byte {}: {} elements {} of at least {} bytes expected, {} bytes left",
                                    source_.path.string(), position_, element_->count, element_->name, row, left));
    }
  }

  [[noreturn]] void fail(const PlyProperty& property, const std::string& what) const {
    throw FormatError(fmt::format("ply: {}: byte {}: element {} {}: property {}: {}", source_.path.string(), position_,
                                  element_->name, row_, property.name, what));
  }

  const Source& source_;
  std::endian order_;
  std::span<const std::byte> bytes_;
  std::size_t position_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

class AsciiBody final : public PlyBody {
 public:
  AsciiBody(const Source& source, TextScanner& scanner)
      : source_(source), scanner_(scanner), size_(source.file.bytes().size()) {}

  PlyRows read(const PlyElement& element, std::vector<std::string>& warnings) override {
    begin(element);
    PlyRows rows;
    const std::vector<Use> uses = uses_of(element, rows, warnings);
    std::vector<TextColumn> columns;
    for (std::size_t p = 0; p < uses.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (uses[p] != Use::Scalar) continue;
      columns.emplace_back(property.name, property.type, element.count);
    }
    std::uint64_t num_long_rows = 0;
    for (row_ = 0; row_ < num_rows(); ++row_) {
      next_row();
      std::size_t column = 0;
      for (std::size_t p = 0; p < uses.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        switch (uses[p]) {
          case Use::Scalar:
            columns[column++].append(scanner_, need_token(property));
            break;
          case Use::Indices:
            read_indices(property, rows.indices);
            break;
          case Use::Texcoords:
            read_texcoords(property, rows.texcoords);
            break;
          case Use::Skipped:
            skip_list(property);
            break;
        }
      }
      if (!scanner_.next_token().empty()) ++num_long_rows;
    }
    if (num_long_rows > 0) {
      warnings.push_back(
          fmt::format("{} rows of element {} hold more values than declared, ignored", num_long_rows, element.name));
    }
    rows.columns = TextColumn::finish(columns, warnings);
    return rows;
  }

  void skip(const PlyElement& element) override {
    begin(element);
    for (row_ = 0; row_ < num_rows(); ++row_) next_row();
  }

 private:
  // Each value takes a digit and a separator, the last one of the file a digit.
  void begin(const PlyElement& element) {
    element_ = &element;
    const std::uint64_t left = size_ - scanner_.byte_offset();
    const std::uint64_t row = 2 * element.properties.size();
    if (row != 0 && element.count > (left + 1) / row) {
      scanner_.fail(fmt::format("{} elements {} expected, only {} bytes left", element.count, element.name, left));
    }
  }

  // An element without properties has no rows in the text.
  [[nodiscard]] std::uint64_t num_rows() const { return element_->properties.empty() ? 0 : element_->count; }

  // Rows are lines; blank lines between them do not count.
  void next_row() {
    poll(source_.context, row_);
    for (;;) {
      const std::optional<std::string_view> line = scanner_.next_line();
      if (!line) {
        scanner_.fail(
            fmt::format("the file ends, expected element {} {} of {}", element_->name, row_, element_->count));
      }
      if (line->find_first_not_of(" \t") != std::string_view::npos) return;
    }
  }

  std::string_view need_token(const PlyProperty& property) {
    const std::string_view token = scanner_.next_token();
    if (token.empty()) {
      scanner_.fail(fmt::format("element {} {}: the row ends, expected {}", element_->name, row_, property.name));
    }
    return token;
  }

  std::uint64_t read_count(const PlyProperty& property) {
    const std::int64_t count = scanner_.need_integer(need_token(property), "the length of a list");
    if (count < 0) scanner_.fail(fmt::format("list {} has {} items, expected 0 or more", property.name, count));
    return static_cast<std::uint64_t>(count);
  }

  void read_indices(const PlyProperty& property, RowLists<Index>& lists) {
    const std::uint64_t count = read_count(property);
    for (std::uint64_t i = 0; i < count; ++i) {
      const double value = scanner_.need_double(need_token(property), "a vertex index");
      const std::optional<Index> index = to_index(value);
      if (!index) scanner_.fail(fmt::format("element {} {}: {} is no vertex index", element_->name, row_, value));
      lists.items.push_back(*index);
    }
    lists.ends.push_back(lists.items.size());
  }

  void read_texcoords(const PlyProperty& property, RowLists<float>& lists) {
    const std::uint64_t count = read_count(property);
    for (std::uint64_t i = 0; i < count; ++i) {
      lists.items.push_back(static_cast<float>(scanner_.need_double(need_token(property), "a texture coordinate")));
    }
    lists.ends.push_back(lists.items.size());
  }

  void skip_list(const PlyProperty& property) {
    for (std::uint64_t left = read_count(property); left > 0; --left) (void)need_token(property);
  }

  const Source& source_;
  TextScanner& scanner_;
  std::size_t size_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

}  // namespace

std::unique_ptr<PlyBody> open_ply_body(const Source& source, const PlyHeader& header, TextScanner& scanner) {
  if (header.ascii) return std::make_unique<AsciiBody>(source, scanner);
  return std::make_unique<BinaryBody>(source, header);
}

}  // namespace shapelight::io
