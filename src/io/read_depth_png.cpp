#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>

#include "io/narrow_columns.hpp"
#include "shapelight/core/error.hpp"

/// 16-bit grey PNG images of a depth camera. A pixel of value 0 saw nothing; the others give, row by row, the point
/// z ((column - cx) / fx, (row - cy) / fy, 1) with z = value / depth_scale. The camera is at the origin.
namespace shapelight::io {
namespace {

struct Camera {
  CameraIntrinsics intrinsics;
  double depth_scale;
};

bool is_usable(const Camera& camera) {
  const CameraIntrinsics& k = camera.intrinsics;
  const bool finite = std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy);
  return finite && k.fx > 0.0 && k.fy > 0.0 && camera.depth_scale > 0.0 && std::isfinite(camera.depth_scale);
}

// "fx fy cx cy [depth_scale]" or the 3 x 3 camera matrix. A scale that the caller chose goes before the file's.
Camera read_camera_file(const std::filesystem::path& path, double chosen_scale) {
  const MappedFile file(path);
  TextScanner scanner(file.text(), "intrinsics", path.string());
  std::vector<double> numbers;
  while (scanner.next_data_line('#')) {
    for (auto token = scanner.next_token(','); !token.empty(); token = scanner.next_token(',')) {
      if (numbers.size() == 9) scanner.fail("more than 9 numbers, expected a 3 x 3 matrix");
      numbers.push_back(scanner.need_double(token, "a number"));
    }
  }
  Camera camera{{}, chosen_scale};
  if (numbers.size() == 9) {
    camera.intrinsics = {numbers[0], numbers[4], numbers[2], numbers[5]};
  } else if (numbers.size() == 4 || numbers.size() == 5) {
    camera.intrinsics = {numbers[0], numbers[1], numbers[2], numbers[3]};
    if (numbers.size() == 5 && chosen_scale == ReadOptions{}.depth_scale) camera.depth_scale = numbers[4];
  } else {
    scanner.fail(fmt::format("{} numbers, expected fx fy cx cy [depth_scale] or a 3 x 3 matrix", numbers.size()));
  }
  if (!is_usable(camera)) scanner.fail("expected finite numbers, fx, fy and depth_scale above 0");
  return camera;
}

Camera find_camera(const Source& source) {
  if (source.options.intrinsics) {
    const Camera camera{*source.options.intrinsics, source.options.depth_scale};
    if (!is_usable(camera)) {
      throw InvalidInput("--intrinsics, --depth-scale: expected finite numbers, fx, fy and the scale above 0");
    }
    return camera;
  }
  const std::string own = source.path.stem().string() + ".intrinsics.txt";
  for (const std::string& name : {own, std::string("camera-intrinsics.txt"), std::string("intrinsics.txt")}) {
    const std::filesystem::path beside = source.path.parent_path() / name;
    if (std::filesystem::is_regular_file(beside)) return read_camera_file(beside, source.options.depth_scale);
  }
  fail_format(
      source, "png",
      fmt::format("the camera is unknown, expected --intrinsics fx,fy,cx,cy or a file {} beside the image", own));
}

struct Memory {
  std::span<const std::byte> bytes;
  std::size_t position = 0;
  std::array<char, 128> message{};
};

void read_memory(png_structp png, png_bytep target, png_size_t size) {
  auto& memory = *static_cast<Memory*>(png_get_io_ptr(png));
  if (size > memory.bytes.size() - memory.position) png_error(png, "the file ends too early");
  std::memcpy(target, memory.bytes.data() + memory.position, size);
  memory.position += size;
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto& memory = *static_cast<Memory*>(png_get_error_ptr(png));
  std::strncpy(memory.message.data(), message, memory.message.size() - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

// libpng leaves these two by longjmp on errors, so nothing in them may need a destructor.
bool read_header(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  return true;
}

bool read_pixels(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

class PngReader {
 public:
  explicit PngReader(const Source& source) : source_(source) {
    memory_.bytes = source.file.bytes();
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &memory_, on_error, on_warning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, &memory_, read_memory);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  // Values row by row, big-endian as in the file.
  std::vector<png_byte> read(std::uint32_t& width, std::uint32_t& height) {
    if (!read_header(png_, info_)) fail(memory_.message.data());
    width = png_get_image_width(png_, info_);
    height = png_get_image_height(png_, info_);
    const int depth = png_get_bit_depth(png_, info_), color = png_get_color_type(png_, info_);
    if (depth != 16 || color != PNG_COLOR_TYPE_GRAY) {
      fail(fmt::format("{} bits per channel, {} channels, expected a depth image of 16 bits and 1 channel", depth,
                       png_get_channels(png_, info_)));
    }
    // Deflate packs at most 1032 to 1, so a small file cannot ask for much memory.
    constexpr std::uint64_t kRatio = 1032;
    const std::uint64_t row_size = 2 * std::uint64_t{width}, pixels = std::uint64_t{width} * height;
    if (pixels > kRatio * memory_.bytes.size() / 2 || pixels > kMaxPoints) {
      fail(fmt::format("{} x {} pixels cannot come out of {} bytes", width, height, memory_.bytes.size()));
    }
    std::vector<png_byte> values(row_size * height);
    std::vector<png_bytep> rows(height);
    for (std::size_t row = 0; row < height; ++row) rows[row] = values.data() + row * row_size;
    if (!read_pixels(png_, rows.data())) fail(memory_.message.data());
    return values;
  }

 private:
  [[noreturn]] void fail(std::string_view message) const {
    fail_format(source_, "png", fmt::format("byte {}: {}", memory_.position, message));
  }

  const Source& source_;
  Memory memory_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

Geometry read_depth_png(const Source& source) {
  RangeGrid grid;
  const std::vector<png_byte> values = PngReader(source).read(grid.width, grid.height);
  const Camera camera = find_camera(source);
  const CameraIntrinsics& k = camera.intrinsics;
  Geometry geometry;
  grid.pixel.assign(std::size_t{grid.width} * grid.height, kNoIndex);
  for (std::size_t i = 0; i < grid.pixel.size(); ++i) {
    const int value = values[2 * i] << 8 | values[2 * i + 1];
    if (value == 0) continue;
    const double z = value / camera.depth_scale;
    const double column = static_cast<double>(i % grid.width), row = static_cast<double>(i / grid.width);
    grid.pixel[i] = static_cast<Index>(geometry.size());
    geometry.positions.emplace_back((column - k.cx) * z / k.fx, (row - k.cy) * z / k.fy, z);
  }
  if (geometry.positions.empty()) fail_format(source, "png", "no pixel has a depth, expected at least one");
  geometry.grid = std::move(grid);
  geometry.viewpoint = Vec3::Zero();
  geometry.format = "png";
  return geometry;
}

}  // namespace shapelight::io
