#include <fmt/format.h>

#include <Eigen/Geometry>

#include "core/poll.hpp"
#include "io/narrow_columns.hpp"

/// Leica PTX: scans of a terrestrial scanner, column by column, each with its matrix. All scans are brought into the
/// common frame by their matrices. Pixels at (0, 0, 0) saw nothing and give no point.
namespace shapelight::io {
namespace {

class PtxReader {
 public:
  explicit PtxReader(const Source& source) : source_(source), scanner_(open_text(source, "ptx")) {}

  Geometry read() {
    while (const std::optional<std::string_view> line = scanner_.next_line()) {
      if (line->find_first_not_of(" \t") != std::string_view::npos) read_scan();
    }
    if (geometry_.positions.empty()) scanner_.fail("the file ends without a measured point, expected at least one");
    if (scan_count_ == 1) {
      geometry_.grid = std::move(grid_);
      geometry_.viewpoint = scanner_position_;
    } else {
      warn_count(geometry_, scan_count_, "scans were joined into one cloud; their pixels and positions were left out");
    }
    if (!columns_[0].empty()) geometry_.attributes.set(float_column("intensity", std::move(columns_[0])));
    if (!columns_[1].empty()) {
      constexpr std::array<std::string_view, 3> kColors = {"red", "green", "blue"};
      set_colors(geometry_.attributes, kColors,
                 {std::move(columns_[1]), std::move(columns_[2]), std::move(columns_[3])});
    }
    geometry_.coordinate_type = narrowest_float(geometry_.positions);
    geometry_.format = "ptx";
    return std::move(geometry_);
  }

 private:
  // The current line holds the number of columns.
  void read_scan() {
    grid_.width = read_size("the number of columns");
    need_line("the number of rows");
    grid_.height = read_size("the number of rows");
    scanner_position_ = read_vector("the scanner's position");
    for (int axis = 0; axis < 3; ++axis) read_vector("the scanner's axes");
    // Rows of the matrix multiply from the left: its last row is the translation.
    for (int row = 0; row < 4; ++row) {
      need_line("a row of the scan's matrix");
      for (int column = 0; column < 4; ++column) {
        world_from_scan_(column, row) = scanner_.need_double(scanner_.next_token(), "4 numbers of the scan's matrix");
      }
    }
    constexpr std::uint64_t kRowSize = 8;  // "0 0 0 0" and a line end
    const std::uint64_t pixels = std::uint64_t{grid_.width} * grid_.height;
    if (pixels > (scanner_.bytes_left() + 1) / kRowSize || pixels > kMaxPoints) {
      scanner_.fail(fmt::format("{} columns of {} rows do not fit into the {} bytes that follow", grid_.width,
                                grid_.height, scanner_.bytes_left()));
    }
    grid_.pixel.assign(pixels, kNoIndex);
    for (std::uint64_t i = 0; i < pixels; ++i) {
      poll(source_.context, i);
      if (!scanner_.next_line()) {
        scanner_.fail(fmt::format("the file ends, expected {} points, found {}", pixels, i));
      }
      read_pixel(i % grid_.height * grid_.width + i / grid_.height);
    }
    ++scan_count_;
  }

  void need_line(std::string_view what) {
    if (!scanner_.next_line()) scanner_.fail(fmt::format("the file ends, expected {}", what));
  }

  std::uint32_t read_size(std::string_view what) {
    const std::int64_t size = scanner_.need_integer(scanner_.next_token(), what);
    if (size < 1 || size > std::numeric_limits<std::uint32_t>::max()) {
      scanner_.fail(fmt::format("{} is {}, expected a positive 32-bit number", what, size));
    }
    return static_cast<std::uint32_t>(size);
  }

  Vec3 read_vector(std::string_view what) {
    need_line(what);
    Vec3 vector;
    for (int axis = 0; axis < 3; ++axis) vector[axis] = scanner_.need_double(scanner_.next_token(), what);
    return vector;
  }

  void read_pixel(std::uint64_t pixel) {
    std::array<double, 7> numbers{};
    std::size_t count = 0;
    for (auto token = scanner_.next_token(); !token.empty(); token = scanner_.next_token()) {
      if (count == numbers.size()) scanner_.fail("more than 7 numbers, expected x y z intensity [r g b]");
      numbers[count++] = scanner_.need_double(token, "x y z intensity [r g b]");
    }
    if (row_size_ == 0 && (count == 4 || count == 7)) row_size_ = count;
    if (count != row_size_ || count == 0) {
      scanner_.fail(fmt::format("{} numbers, expected x y z intensity [r g b], alike in every row", count));
    }
    const Vec3 point(numbers[0], numbers[1], numbers[2]);
    if (!point.allFinite() || point.isZero(0.0)) return;
    if (geometry_.size() == kMaxPoints) scanner_.fail(fmt::format("expected at most {} points", kMaxPoints));
    grid_.pixel[pixel] = static_cast<Index>(geometry_.size());
    geometry_.positions.emplace_back((world_from_scan_ * point.homogeneous()).head<3>());
    for (std::size_t k = 3; k < count; ++k) columns_[k - 3].push_back(numbers[k]);
  }

  const Source& source_;
  TextScanner scanner_;
  Geometry geometry_;
  RangeGrid grid_;  // of the last scan
  Vec3 scanner_position_ = Vec3::Zero();
  Eigen::Matrix4d world_from_scan_;
  std::array<std::vector<double>, 4> columns_;  // intensity, red, green, blue
  std::size_t row_size_ = 0;
  std::size_t scan_count_ = 0;
};

}  // namespace

Geometry read_ptx(const Source& source) { return PtxReader(source).read(); }

}  // namespace shapelight::io
