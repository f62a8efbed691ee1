#include "render/raster.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace shapelight::drawing {
namespace {

constexpr int kBandRows = 32;
constexpr int kHalf = kSubpixels / 2;

struct Rows {
  std::int32_t first = 0;
  std::int32_t last = -1;
};

/// First and last sample whose centre lies in [low, high], both in 1/256 sample.
Rows covered(std::int32_t low, std::int32_t high) { return {(low + kHalf - 1) >> 8, (high - kHalf) >> 8}; }

std::array<std::uint8_t, 3> to_bytes(const Vec3f& color) {
  std::array<std::uint8_t, 3> bytes;
  for (int c = 0; c < 3; ++c) bytes[c] = static_cast<std::uint8_t>(std::clamp(color[c], 0.0F, 1.0F) * 255.0F + 0.5F);
  return bytes;
}

/// Edge functions of a triangle on the screen, positive inside whichever way it winds.
class TriangleSetup {
 public:
  TriangleSetup(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c) : corner_{&a, &b, &c} {
    area_ = cross(a, b, c.x, c.y);
    if (area_ < 0) {
      std::swap(corner_[1], corner_[2]);
      order_ = {0, 2, 1};
      area_ = -area_;
    }
    for (int k = 0; k < 3; ++k) {
      const ScreenPoint& from = *corner_[(k + 1) % 3];
      const ScreenPoint& to = *corner_[(k + 2) % 3];
      // A sample exactly on a shared edge belongs to one side only: to the triangle whose edge points left or up.
      const bool owns = to.y < from.y || (to.y == from.y && to.x < from.x);
      bias_[k] = owns ? 0 : -1;
    }
  }

  [[nodiscard]] bool visible() const { return area_ > 0; }
  /// Barycentric weights of a sample's centre by the triangle's own corner order, when it is covered.
  [[nodiscard]] bool weights(int column, int row, std::array<float, 3>& weight) const {
    const std::int64_t x = static_cast<std::int64_t>(column) * kSubpixels + kHalf;
    const std::int64_t y = static_cast<std::int64_t>(row) * kSubpixels + kHalf;
    const float scale = 1.0F / static_cast<float>(area_);
    for (int k = 0; k < 3; ++k) {
      const std::int64_t edge = cross(*corner_[(k + 1) % 3], *corner_[(k + 2) % 3], x, y);
      if (edge + bias_[k] < 0) return false;
      weight[order_[k]] = static_cast<float>(edge) * scale;
    }
    return true;
  }

 private:
  static std::int64_t cross(const ScreenPoint& a, const ScreenPoint& b, std::int64_t x, std::int64_t y) {
    return (static_cast<std::int64_t>(b.x) - a.x) * (y - a.y) - (static_cast<std::int64_t>(b.y) - a.y) * (x - a.x);
  }
  std::array<const ScreenPoint*, 3> corner_;
  std::array<int, 3> order_ = {0, 1, 2};
  std::array<int, 3> bias_{};
  std::int64_t area_ = 0;
};

/// One band of rows; `fragments` are its part of the frame.
struct Band {
  int width = 0;
  int first_row = 0;
  int last_row = 0;
  std::span<Fragment> fragments;
  [[nodiscard]] std::size_t slot(int column, int row) const {
    return static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] bool touches(const Rows& rows) const { return rows.first <= last_row && rows.last >= first_row; }
};

class Rasterizer {
 public:
  Rasterizer(const Geometry& geometry, const Surface& surface, const Paint& paint, const Camera& camera,
             const RunContext& context)
      : surface_(surface),
        paint_(paint),
        camera_(camera),
        rotation_(camera.axes.cast<float>()),
        screen_(geometry.size()) {
    parallel::for_chunks(context, screen_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) screen_[i] = camera.project(geometry.positions[i]);
    });
    const bool discs = surface.triangles.empty();
    rows_.resize(discs ? geometry.size() : surface.triangles.size());
    parallel::for_chunks(context, rows_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) rows_[i] = discs ? disc_rows(i) : triangle_rows(i);
    });
  }

  void draw(const Band& band) const {
    if (surface_.triangles.empty()) {
      draw_discs(band);
    } else {
      draw_triangles(band);
    }
  }

 private:
  [[nodiscard]] Rows triangle_rows(std::size_t t) const {
    const auto& [i, j, k] = surface_.triangles[t];
    const ScreenPoint &a = screen_[i], &b = screen_[j], &c = screen_[k];
    if (a.nearness == 0.0F || b.nearness == 0.0F || c.nearness == 0.0F) return {};
    return covered(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
  }
  [[nodiscard]] float disc_radius(std::size_t i) const {  // [samples]
    if (paint_.point_radius > 0.0) return static_cast<float>(paint_.point_radius);
    return std::max(0.9F, surface_.radius[i] * static_cast<float>(camera_.scale) * screen_[i].nearness);
  }
  [[nodiscard]] Rows disc_rows(std::size_t i) const {
    if (screen_[i].nearness == 0.0F) return {};
    const auto reach = static_cast<std::int32_t>(std::ceil(std::min(disc_radius(i), 4096.0F) * kSubpixels));
    return covered(screen_[i].y - reach, screen_[i].y + reach);
  }
  [[nodiscard]] Vec3f color_of(std::size_t i) const {
    const Color& color = paint_.colors.empty() ? paint_.plain : paint_.colors[i];
    return {color[0], color[1], color[2]};
  }
  /// In the camera frame, turned towards the eye.
  [[nodiscard]] Vec3f facing_normal(std::size_t i) const {
    const Vec3f normal = rotation_ * surface_.normals[i];
    return normal.z() < 0.0F ? Vec3f(-normal) : normal;
  }

  void draw_triangles(const Band& band) const;
  void resolve_triangles(const Band& band, const std::vector<Index>& seen) const;
  void draw_discs(const Band& band) const;
  template <class Visit>
  void visit_disc(const Band& band, std::size_t i, Visit&& visit) const;

  const Surface& surface_;
  const Paint& paint_;
  const Camera& camera_;
  Eigen::Matrix3f rotation_;
  std::vector<ScreenPoint> screen_;
  std::vector<Rows> rows_;  // of every primitive
};

void Rasterizer::draw_triangles(const Band& band) const {
  std::vector<Index> seen(band.fragments.size(), kNoIndex);
  std::array<float, 3> weight{};
  for (Index t = 0; t < rows_.size(); ++t) {
    if (!band.touches(rows_[t])) continue;
    const auto& [i, j, k] = surface_.triangles[t];
    const ScreenPoint &a = screen_[i], &b = screen_[j], &c = screen_[k];
    const Rows columns = covered(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}));
    const TriangleSetup setup(a, b, c);
    if (!setup.visible()) continue;
    for (int row = std::max(rows_[t].first, band.first_row); row <= std::min(rows_[t].last, band.last_row); ++row) {
      for (int column = std::max(columns.first, 0); column <= std::min(columns.last, band.width - 1); ++column) {
        if (!setup.weights(column, row, weight)) continue;
        const float nearness = weight[0] * a.nearness + weight[1] * b.nearness + weight[2] * c.nearness;
        const std::size_t slot = band.slot(column, row);
        if (nearness > band.fragments[slot].nearness) {
          band.fragments[slot].nearness = nearness;
          seen[slot] = t;
        }
      }
    }
  }
  resolve_triangles(band, seen);
}

/// Normals and colours of what is seen, once per sample. A corner whose normal is far from the triangle's belongs to
/// a crease: the triangle's own normal takes over there, which keeps machined edges sharp.
void Rasterizer::resolve_triangles(const Band& band, const std::vector<Index>& seen) const {
  constexpr float kSmooth = 0.87F, kCrease = 0.74F;     // cosines of about 30 and 42 degrees
  const bool creases = surface_.own_triangles.empty();  // a range image is too noisy to have any
  for (std::size_t slot = 0; slot < seen.size(); ++slot) {
    if (seen[slot] == kNoIndex) continue;
    const Triangle& triangle = surface_.triangles[seen[slot]];
    const ScreenPoint &a = screen_[triangle[0]], &b = screen_[triangle[1]], &c = screen_[triangle[2]];
    std::array<float, 3> weight{};
    const auto column = static_cast<int>(slot % static_cast<std::size_t>(band.width));
    const auto row = band.first_row + static_cast<int>(slot / static_cast<std::size_t>(band.width));
    if (!TriangleSetup(a, b, c).weights(column, row, weight)) continue;
    const std::array<const ScreenPoint*, 3> corner = {&a, &b, &c};
    std::array<Vec3f, 3> place;
    float total = 0.0F;
    for (int k = 0; k < 3; ++k) {
      weight[k] *= corner[k]->nearness;  // perspective: weights are linear in space, not on the screen
      total += weight[k];
      place[k] = camera_.unproject(static_cast<float>(corner[k]->x) / kSubpixels,
                                   static_cast<float>(corner[k]->y) / kSubpixels, corner[k]->nearness);
    }
    Vec3f face = (place[1] - place[0]).cross(place[2] - place[0]);
    const float face_length = face.norm();
    if (face_length > 0.0F) face /= face.z() < 0.0F ? -face_length : face_length;
    Vec3f normal = Vec3f::Zero();
    Vec3f color = Vec3f::Zero();
    for (int k = 0; k < 3; ++k) {
      Vec3f at_corner = rotation_ * surface_.normals[triangle[k]];
      if (at_corner.dot(face) < 0.0F) at_corner = -at_corner;
      const float smooth =
          creases ? std::clamp((at_corner.dot(face) - kCrease) / (kSmooth - kCrease), 0.0F, 1.0F) : 1.0F;
      normal += weight[k] * (smooth * at_corner + (1.0F - smooth) * face);
      color += weight[k] / total * color_of(triangle[k]);
    }
    const auto nearest = std::max_element(weight.begin(), weight.end()) - weight.begin();
    if (paint_.flat) color = color_of(triangle[static_cast<std::size_t>(nearest)]);
    normal.normalize();
    Fragment& fragment = band.fragments[slot];
    fragment.normal = {normal.x(), normal.y(), normal.z()};
    fragment.color = to_bytes(color);
  }
}

/// Calls visit(slot, nearness, weight) for the samples of disc i in the band; weight falls from 1 to 0 at the rim.
template <class Visit>
void Rasterizer::visit_disc(const Band& band, std::size_t i, Visit&& visit) const {
  constexpr float kSteepest = 0.25F;  // discs seen from the side keep this share of their width, so that none vanishes
  const ScreenPoint& p = screen_[i];
  const float radius = disc_radius(i);
  const Vec3f normal = facing_normal(i);
  const float facing = std::max(normal.z(), kSteepest);
  const bool oriented = normal.squaredNorm() > 0.5F && radius > 1.0F;
  const float slope_x = oriented ? -normal.x() / facing : 0.0F;
  const float slope_y = oriented ? normal.y() / facing : 0.0F;  // screen rows run downwards
  const float center_x = static_cast<float>(p.x) / kSubpixels - 0.5F;
  const float center_y = static_cast<float>(p.y) / kSubpixels - 0.5F;
  // d nearness / d z = nearness^2 / distance, and a sample is 1 / (scale nearness) long.
  const float per_sample = p.nearness / static_cast<float>(camera_.scale * camera_.distance);
  const int first = std::max(0, static_cast<int>(std::ceil(center_x - radius)));
  const int last = std::min(band.width - 1, static_cast<int>(std::floor(center_x + radius)));
  for (int row = std::max(rows_[i].first, band.first_row); row <= std::min(rows_[i].last, band.last_row); ++row) {
    const float dy = static_cast<float>(row) - center_y;
    for (int column = first; column <= last; ++column) {
      const float dx = static_cast<float>(column) - center_x;
      const float dz = slope_x * dx + slope_y * dy;
      const float share = (dx * dx + dy * dy + dz * dz) / (radius * radius);
      if (share < 1.0F) visit(band.slot(column, row), p.nearness + dz * per_sample, 1.0F - share);
    }
  }
}

/// Two passes: the nearest disc gives the depth, then all discs up to a radius behind it are blended, so that
/// overlapping discs of one surface look like that surface.
void Rasterizer::draw_discs(const Band& band) const {
  std::vector<Index> touching;
  for (Index i = 0; i < rows_.size(); ++i) {
    if (band.touches(rows_[i])) touching.push_back(i);
  }
  for (const Index i : touching) {
    visit_disc(band, i, [&](std::size_t slot, float nearness, float) {
      band.fragments[slot].nearness = std::max(band.fragments[slot].nearness, nearness);
    });
  }
  struct Blend {
    Vec3f normal = Vec3f::Zero();
    Vec3f color = Vec3f::Zero();
    float weight = 0.0F;
  };
  std::vector<Blend> blends(band.fragments.size());
  for (const Index i : touching) {
    const Vec3f normal = facing_normal(i);
    const Vec3f color = color_of(i);
    const float depth =
        1.5F * disc_radius(i) * screen_[i].nearness / static_cast<float>(camera_.scale * camera_.distance);
    visit_disc(band, i, [&](std::size_t slot, float nearness, float weight) {
      if (nearness < band.fragments[slot].nearness - depth) return;
      Blend& blend = blends[slot];
      const float w = weight * weight + 1e-4F;
      blend.normal += w * normal;
      blend.color = paint_.flat ? (w > blend.weight ? color : blend.color) : Vec3f(blend.color + w * color);
      blend.weight = paint_.flat ? std::max(blend.weight, w) : blend.weight + w;
    });
  }
  for (std::size_t slot = 0; slot < blends.size(); ++slot) {
    const Blend& blend = blends[slot];
    if (blend.weight == 0.0F) continue;
    const Vec3f normal = blend.normal.normalized();
    band.fragments[slot].normal = {normal.x(), normal.y(), normal.z()};
    band.fragments[slot].color = to_bytes(paint_.flat ? blend.color : Vec3f(blend.color / blend.weight));
  }
}

}  // namespace

Frame rasterize(const Geometry& geometry, const Surface& surface, const Paint& paint, const Camera& camera, int width,
                int height, const RunContext& context) {
  Frame frame{width, height, {}};
  frame.fragments.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const Rasterizer rasterizer(geometry, surface, paint, camera, context);
  parallel::for_chunks(
      context, static_cast<std::size_t>(height),
      [&](std::size_t begin, std::size_t end) {
        const std::size_t row = static_cast<std::size_t>(width);
        rasterizer.draw({width, static_cast<int>(begin), static_cast<int>(end) - 1,
                         std::span(frame.fragments).subspan(begin * row, (end - begin) * row)});
      },
      kBandRows);
  return frame;
}

}  // namespace shapelight::drawing
