#include "render/shade.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"

namespace shapelight::drawing {
namespace {

constexpr std::size_t kRows = 16;  // of pixels per chunk of work

float linear_of(std::uint8_t byte) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i)
      t[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / 255.0));
    return t;
  }();
  return table[byte];
}

std::uint8_t byte_of(float linear) {
  constexpr std::size_t kSteps = 4096;
  static const std::array<std::uint8_t, kSteps + 1> table = [] {
    std::array<std::uint8_t, kSteps + 1> t{};
    for (std::size_t i = 0; i <= kSteps; ++i) {
      t[i] = static_cast<std::uint8_t>(linear_to_srgb(static_cast<double>(i) / kSteps) * 255.0 + 0.5);
    }
    return t;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.0F, 1.0F) * kSteps + 0.5F)];
}

Vec3f linear_color(const std::array<std::uint8_t, 3>& c) { return {linear_of(c[0]), linear_of(c[1]), linear_of(c[2])}; }

/// The samples of the picture's pixels that ambient occlusion works on: one per block.
class Blocks {
 public:
  Blocks(const Frame& frame, const Camera& camera, int size)
      : width(frame.width / size), height(frame.height / size), frame_(frame), camera_(camera), size_(size) {}
  [[nodiscard]] const Fragment& at(int x, int y) const {
    return frame_.at(x * size_ + size_ / 2, y * size_ + size_ / 2);
  }
  [[nodiscard]] Vec3f place(int x, int y) const {
    const auto center = [&](int i) { return static_cast<float>(i * size_ + size_ / 2) + 0.5F; };
    return camera_.unproject(center(x), center(y), at(x, y).nearness);
  }
  int width, height;

 private:
  const Frame& frame_;
  const Camera& camera_;
  int size_;
};

constexpr int kTaps = 16;
constexpr int kPattern = 4;  // sample spirals turn in tiles of 4 x 4 pixels, which the blur averages away

/// Offsets along a spiral, for each of the turns of the tile; unit disc.
using Spirals = std::array<std::array<std::array<float, 2>, kTaps>, kPattern * kPattern>;
Spirals make_spirals() {
  Spirals spirals{};
  for (std::size_t turn = 0; turn < spirals.size(); ++turn) {
    for (std::size_t k = 0; k < kTaps; ++k) {
      constexpr double kGoldenAngle = std::numbers::pi * (3.0 - 2.23606797749979);
      // Consecutive turns are spread over the tile by an odd multiplier.
      const double start = 2.0 * std::numbers::pi * static_cast<double>(turn * 7 % spirals.size()) / spirals.size();
      const double angle = kGoldenAngle * static_cast<double>(k) + start;
      const double radius =
          (static_cast<double>(k) + 0.5 + static_cast<double>(turn) / spirals.size() * 0.5) / (kTaps + 0.5);
      spirals[turn][k] = {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))};
    }
  }
  return spirals;
}

/// Share of the sky that the surroundings within `reach` [length] hide from a pixel.
float hidden_share(const Blocks& blocks, int x, int y, float reach, float reach_pixels,
                   const std::array<std::array<float, 2>, kTaps>& spiral) {
  const Vec3f place = blocks.place(x, y);
  const auto& n = blocks.at(x, y).normal;
  const Vec3f normal(n[0], n[1], n[2]);
  const float pixels = reach_pixels * blocks.at(x, y).nearness;
  float hidden = 0.0F;
  for (const auto& tap : spiral) {
    const int tap_x = x + static_cast<int>(std::lround(tap[0] * pixels));
    const int tap_y = y + static_cast<int>(std::lround(tap[1] * pixels));
    if (tap_x < 0 || tap_y < 0 || tap_x >= blocks.width || tap_y >= blocks.height) continue;
    if (blocks.at(tap_x, tap_y).nearness == 0.0F) continue;
    const Vec3f to = blocks.place(tap_x, tap_y) - place;
    const float squared = to.squaredNorm();
    if (squared == 0.0F) continue;
    constexpr float kHorizon = 0.08F;  // below it lie the surface's own curvature and rounding
    const float rise = std::max(0.0F, to.dot(normal) / std::sqrt(squared) - kHorizon);
    // Things far in front of the surface do not darken it.
    hidden += rise * std::max(0.0F, 1.0F - squared / (2.25F * reach * reach));
  }
  return hidden / kTaps;
}

/// Averages over the tile of turns around a pixel, but not across depth jumps.
float blurred(const Blocks& blocks, std::span<const float> values, int x, int y, float jump) {
  float sum = 0.0F;
  float count = 0.0F;
  const float nearness = blocks.at(x, y).nearness;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const int u = x + dx, v = y + dy;
      if (u < 0 || v < 0 || u >= blocks.width || v >= blocks.height) continue;
      if (std::abs(blocks.at(u, v).nearness - nearness) > jump) continue;
      // A tile is four wide: half weights at both ends make five columns one tile.
      const float weight = (std::abs(dx) == 2 ? 0.5F : 1.0F) * (std::abs(dy) == 2 ? 0.5F : 1.0F);
      sum += weight * values[static_cast<std::size_t>(v) * blocks.width + u];
      count += weight;
    }
  }
  return sum / count;
}

/// Lights of a photographer's table, fixed to the camera: a key light from the upper left, a headlight, and a sky
/// that is brighter above. Linear light.
Vec3f lit(const Fragment& fragment, float ambient) {
  static const Vec3f key = Vec3f(-0.50F, 0.62F, 0.62F).normalized();
  static const Vec3f half_way = (key + Vec3f::UnitZ()).normalized();
  const Vec3f normal(fragment.normal[0], fragment.normal[1], fragment.normal[2]);
  const Vec3f albedo = linear_color(fragment.color);
  if (normal.squaredNorm() < 0.5F) return albedo * (0.85F * ambient);
  const float direct = std::max(0.0F, normal.dot(key));
  const float head = std::max(0.0F, normal.z());
  const float sky = 0.5F + 0.5F * normal.y();
  const float diffuse = 0.74F * direct * (0.35F + 0.65F * ambient) + (0.24F * head + 0.05F + 0.17F * sky) * ambient;
  const float gloss = std::pow(std::max(0.0F, normal.dot(half_way)), 28.0F);
  return albedo * (1.06F * diffuse) + Vec3f::Constant(0.05F * gloss * ambient);
}

/// Draws the dots that touch rows [first, first + rows) over those rows.
void draw_dots(std::span<const Dot> dots, const DotStyle& style, int width, int first, int rows,
               std::vector<Vec3f>& light) {
  const auto bytes = [](float c) { return static_cast<std::uint8_t>(c * 255.0F + 0.5F); };
  const Vec3f inside = linear_color({bytes(style.color[0]), bytes(style.color[1]), bytes(style.color[2])});
  const Vec3f rim = 0.10F * inside;
  for (const Dot& dot : dots) {
    const int top = std::max(first, static_cast<int>(std::floor(dot.y - style.radius)));
    const int bottom = std::min(first + rows - 1, static_cast<int>(std::ceil(dot.y + style.radius)));
    const int left = std::max(0, static_cast<int>(std::floor(dot.x - style.radius)));
    const int right = std::min(width - 1, static_cast<int>(std::ceil(dot.x + style.radius)));
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const float dx = static_cast<float>(x) + 0.5F - dot.x, dy = static_cast<float>(y) + 0.5F - dot.y;
        const float squared = dx * dx + dy * dy;
        if (squared > style.radius * style.radius) continue;
        const float core = style.radius - style.rim;
        light[static_cast<std::size_t>(y - first) * width + x] = squared <= core * core ? inside : rim;
      }
    }
  }
}

}  // namespace

std::vector<float> ambient_light(const Frame& frame, const Camera& camera, int supersample, double strength,
                                 const RunContext& context) {
  static const Spirals spirals = make_spirals();
  const Blocks blocks(frame, camera, supersample);
  std::vector<float> ambient(static_cast<std::size_t>(blocks.width) * blocks.height, 1.0F);
  if (strength <= 0.0) return ambient;
  std::vector<float> raw(ambient.size(), 1.0F);
  const float reach_pixels = 0.055F * static_cast<float>(std::min(blocks.width, blocks.height));
  const float reach = reach_pixels * static_cast<float>(supersample / camera.scale);
  const auto for_pixels = [&](auto&& body) {
    parallel::for_chunks(
        context, static_cast<std::size_t>(blocks.height),
        [&](std::size_t begin, std::size_t end) {
          for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            for (int x = 0; x < blocks.width; ++x) {
              if (blocks.at(x, y).nearness > 0.0F) body(x, y, static_cast<std::size_t>(y) * blocks.width + x);
            }
          }
        },
        kRows);
  };
  for_pixels([&](int x, int y, std::size_t slot) {
    const auto& spiral = spirals[static_cast<std::size_t>((y % kPattern) * kPattern + x % kPattern)];
    const float hidden = hidden_share(blocks, x, y, reach, reach_pixels, spiral);
    raw[slot] = std::max(0.0F, 1.0F - static_cast<float>(2.6 * strength) * hidden);
  });
  const float jump = 0.5F * reach / static_cast<float>(camera.distance);
  for_pixels([&](int x, int y, std::size_t slot) { ambient[slot] = blurred(blocks, raw, x, y, jump); });
  return ambient;
}

std::vector<Dot> visible_dots(std::span<const Vec3> points, const Frame& frame, const Camera& camera) {
  // A dot lies on the surface, give or take the spacing of the points: about 0.6 % of the view.
  const auto tolerance =
      static_cast<float>(0.006 * std::min(frame.width, frame.height) / (camera.scale * camera.distance));
  std::vector<Dot> dots;
  for (const Vec3& point : points) {
    const ScreenPoint p = camera.project(point);
    const int column = p.x >> 8, row = p.y >> 8;
    if (p.nearness == 0.0F || column < 0 || row < 0 || column >= frame.width || row >= frame.height) continue;
    if (frame.at(column, row).nearness > p.nearness + tolerance) continue;
    dots.push_back({static_cast<float>(p.x) / kSubpixels, static_cast<float>(p.y) / kSubpixels, p.nearness});
  }
  std::stable_sort(dots.begin(), dots.end(), [](const Dot& a, const Dot& b) { return a.nearness < b.nearness; });
  return dots;
}

Image shade(const Frame& frame, std::span<const float> ambient, std::span<const Dot> dots, const DotStyle& style,
            Pixel background, int supersample, const RunContext& context) {
  Image image(frame.width / supersample, frame.height / supersample, background);
  const Vec3f paper = linear_color(background);
  parallel::for_chunks(
      context, static_cast<std::size_t>(image.height),
      [&](std::size_t begin, std::size_t end) {
        const int first = static_cast<int>(begin) * supersample;
        const int rows = static_cast<int>(end - begin) * supersample;
        std::vector<Vec3f> light(static_cast<std::size_t>(rows) * frame.width, paper);
        for (int y = 0; y < rows; ++y) {
          for (int x = 0; x < frame.width; ++x) {
            const Fragment& fragment = frame.at(x, first + y);
            if (fragment.nearness == 0.0F) continue;
            const std::size_t pixel =
                static_cast<std::size_t>((first + y) / supersample) * image.width + x / supersample;
            light[static_cast<std::size_t>(y) * frame.width + x] = lit(fragment, ambient[pixel]);
          }
        }
        draw_dots(dots, style, frame.width, first, rows, light);
        for (int y = 0; y < rows / supersample; ++y) {
          for (int x = 0; x < image.width; ++x) {
            Vec3f sum = Vec3f::Zero();
            for (int v = 0; v < supersample; ++v) {
              for (int u = 0; u < supersample; ++u) {
                sum += light[static_cast<std::size_t>(y * supersample + v) * frame.width + x * supersample + u];
              }
            }
            sum /= static_cast<float>(supersample * supersample);
            image.at(x, static_cast<int>(begin) + y) = {byte_of(sum.x()), byte_of(sum.y()), byte_of(sum.z())};
          }
        }
      },
      kRows);
  return image;
}

}  // namespace shapelight::drawing
