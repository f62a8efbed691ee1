#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "io/formats.hpp"
#include "io/las_layout.hpp"
#include "io/scalar_bytes.hpp"
#include "shapelight/core/error.hpp"

// Coordinates are stored as round((p - offset) / scale) in 32 bits. A geometry read from LAS keeps its scale, offset,
// point format and records, so its stored numbers come out as they went in; it gets a new grid only when a point has
// moved out of reach. Any other geometry becomes LAS 1.4 in format 6, 7 (colours) or 8 (near infrared), on the finest
// power of ten for which its box fits 32 bits, so that at most 1e-9 of the box is lost.
namespace shapelight::io {
namespace {

using namespace las;

constexpr std::size_t kFlushBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxExtraDimensions = 65535 / kExtraDescriptorSize;  // of one record
constexpr double kMaxRaw = std::numeric_limits<std::int32_t>::max();

struct Grid {
  std::array<double, 3> scale{}, offset{};

  // Nothing when out of reach.
  [[nodiscard]] std::optional<std::array<std::int32_t, 3>> raw(const Vec3& p) const {
    std::array<std::int32_t, 3> steps{};
    for (int axis = 0; axis < 3; ++axis) {
      const double step = std::round((p[axis] - offset[axis]) / scale[axis]);
      if (!(std::abs(step) <= kMaxRaw)) return std::nullopt;
      steps[axis] = static_cast<std::int32_t>(step);
    }
    return steps;
  }
};

// A column, and where its values go.
struct Target {
  const Column* column = nullptr;
  Field field;
  double factor = 1.0;
  std::string extra_name;  // empty: a field of the point format
};

struct Plan {
  std::vector<std::byte> header;
  std::vector<std::byte> vlrs;
  std::uint8_t point_format = 0;
  std::size_t stride = 0;
  Grid grid;
  std::vector<Target> targets;
  std::vector<Index> points;     // those with finite coordinates
  std::vector<std::byte> blank;  // a record before its values are put in

  [[nodiscard]] bool is_14() const {
    return header.size() >= kHeaderSize14 && load<std::uint8_t>(header.data() + kVersionMinor) >= 4;
  }
};

bool holds(const Field& field, const Column& column) {
  if (field.bits == 0 && field.type == column.type()) return true;
  return with_type(field.type, [&]<class T>(T) {
    // Doubles count 64-bit integers one by one up to 2^53 only.
    const double type_high =
        std::is_integral_v<T> && sizeof(T) == 8 ? 9e15 : static_cast<double>(std::numeric_limits<T>::max());
    const double high = field.bits != 0 ? (1 << field.bits) - 1 : type_high;
    const double low = static_cast<double>(std::numeric_limits<T>::lowest());
    for (std::size_t i = 0; i < column.size(); ++i) {
      const double v = column.as_double(i);
      if (!(v >= low && v <= high && static_cast<double>(static_cast<T>(v)) == v)) return false;
    }
    return true;
  });
}

Grid fresh_grid(const Geometry& g) {
  const BoundingBox box = bounding_box(g.positions);
  const double size = (box.max - box.min).maxCoeff();
  if (!std::isfinite(size)) throw InvalidInput("las: the box of the points is too large for double precision");
  const double extent = size > 0.0 ? size : 1.0;
  Grid grid;
  grid.scale.fill(std::pow(10.0, std::ceil(std::log10(extent / 4e9))));
  for (int axis = 0; axis < 3; ++axis) {
    // Whole units keep the header readable; small boxes cannot spare the unit by which that shifts them.
    const double center = box.center()[axis];
    grid.offset[axis] = extent < 100.0 ? center : std::floor(center);
  }
  return grid;
}

bool reaches_all(const Grid& grid, const Geometry& g, const std::vector<Index>& points) {
  return std::all_of(points.begin(), points.end(), [&](Index i) { return grid.raw(g.positions[i]).has_value(); });
}

void set_text(std::byte* to, std::string_view text, std::size_t size) {
  std::memcpy(to, text.data(), std::min(text.size(), size));
}

std::vector<std::byte> fresh_header() {
  std::vector<std::byte> header(kHeaderSize14);
  set_text(header.data(), "LASF", 4);
  store<std::uint16_t>(header.data() + kGlobalEncoding, 0x10);  // formats 6 to 10 ask for WKT, even when there is none
  store<std::uint8_t>(header.data() + kVersionMinor - 1, 1);
  store<std::uint8_t>(header.data() + kVersionMinor, 4);
  set_text(header.data() + 26, "OTHER", 32);
  set_text(header.data() + 58, "shapelight", 32);
  store(header.data() + kHeaderSize, static_cast<std::uint16_t>(kHeaderSize14));
  return header;
}

std::uint8_t fresh_point_format(const AttributeTable& attributes) {
  if (attributes.find("nir") != nullptr) return 8;
  return attributes.find("red") != nullptr ? 7 : 6;
}

// 8-bit colours fill 16 bits: 255 becomes 65535. Angles are whole degrees in formats 0 to 5, then steps of 0.006.
double unit_factor(const Field& field, const Column& column) {
  const bool is_color = field.name == "red" || field.name == "green" || field.name == "blue";
  if (is_color && column.type() == ScalarType::UInt8) return 257.0;
  const bool is_wide_angle = field.name == "scan_angle" && field.type == ScalarType::Int16;
  return is_wide_angle && column.type() == ScalarType::Int8 ? 1.0 / 0.006 : 1.0;
}

// Standard attributes go to their fields when these hold every value; everything else becomes an extra dimension.
void place_columns(const Geometry& g, Plan& plan, DroppedAttributes& dropped) {
  const std::vector<Field> fields = point_fields(plan.point_format);
  std::set<std::string> names;
  std::size_t num_extra = 0;
  for (const Column& column : g.attributes.columns()) {
    if (column.size() != g.size()) {
      dropped.push_back(column.name);
      continue;
    }
    const auto known =
        std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == column.name; });
    if (known != fields.end() && holds(*known, column)) {
      plan.targets.push_back({&column, *known, unit_factor(*known, column), {}});
      continue;
    }
    std::string name = known != fields.end() ? column.name + "_value" : column.name;
    name.resize(std::min<std::size_t>(name.size(), 32));
    const std::size_t size = scalar_type_size(column.type());
    if (name.empty() || num_extra == kMaxExtraDimensions || plan.stride + size > 65535 || !names.insert(name).second) {
      dropped.push_back(column.name);
      continue;
    }
    plan.targets.push_back({&column, {"", column.type(), static_cast<std::uint16_t>(plan.stride)}, 1.0, name});
    plan.stride += size;
    ++num_extra;
  }
}

// The descriptor that the file had for this dimension, with its unit, range and scale; else a plain new one.
std::vector<std::byte> descriptor_of(const Target& target, const std::vector<ExtraDimension>& former) {
  const ScalarType type = target.column->type();
  for (const ExtraDimension& d : former) {
    if (d.name == target.extra_name && d.type == type && d.components == 1) {
      return {d.descriptor.begin(), d.descriptor.end()};
    }
  }
  std::vector<std::byte> descriptor(kExtraDescriptorSize);
  store(descriptor.data() + 2, extra_type_code(type));
  set_text(descriptor.data() + 4, target.extra_name, 32);
  return descriptor;
}

// All former records but the extra bytes, then the extra bytes as they are now, then what stood behind the records.
std::uint32_t build_vlrs(const Geometry& g, bool keeps_header, Plan& plan) {
  std::uint32_t num_vlrs = 0;
  std::vector<ExtraDimension> former;
  std::span<const std::byte> left;
  if (keeps_header) {
    left = g.las->vlrs;
    for (auto n = load<std::uint32_t>(plan.header.data() + kNumVlrs); n > 0; --n) {
      const std::optional<Vlr> vlr = first_vlr(left);
      if (!vlr) throw InvalidInput("las: LasInfo::vlrs ends within a record, expected whole records");
      if (vlr->is_extra_bytes()) {
        for (ExtraDimension& d : extra_dimensions(vlr->payload())) former.push_back(std::move(d));
      } else {
        plan.vlrs.insert(plan.vlrs.end(), vlr->whole.begin(), vlr->whole.end());
        ++num_vlrs;
      }
      left = left.subspan(vlr->whole.size());
    }
  }
  std::vector<std::byte> payload;
  for (const Target& target : plan.targets) {
    if (target.extra_name.empty()) continue;
    const std::vector<std::byte> descriptor = descriptor_of(target, former);
    payload.insert(payload.end(), descriptor.begin(), descriptor.end());
  }
  if (!payload.empty()) {
    std::vector<std::byte> head(kVlrHeaderSize);
    set_text(head.data() + 2, "LASF_Spec", 16);
    store(head.data() + 18, kExtraBytesRecord);
    store(head.data() + 20, static_cast<std::uint16_t>(payload.size()));
    plan.vlrs.insert(plan.vlrs.end(), head.begin(), head.end());
    plan.vlrs.insert(plan.vlrs.end(), payload.begin(), payload.end());
    ++num_vlrs;
  }
  plan.vlrs.insert(plan.vlrs.end(), left.begin(), left.end());
  return num_vlrs;
}

// The share of the record that the columns fill; the rest of it stays as in `blank`.
void put_values(const Plan& plan, Index i, std::byte* record) {
  for (const Target& target : plan.targets) {
    std::byte* to = record + target.field.offset;
    std::visit(
        [&](const auto& values) {
          with_type(target.field.type, [&]<class T>(T) {
            if (target.field.bits != 0) {
              *to |= static_cast<std::byte>(static_cast<unsigned>(values[i]) << target.field.shift);
            } else if (target.factor != 1.0) {
              store(to, static_cast<T>(std::round(static_cast<double>(values[i]) * target.factor)));
            } else {
              store(to, static_cast<T>(values[i]));
            }
          });
        },
        target.column->values);
  }
}

void store_bounds(const Geometry& g, Plan& plan) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Index i : plan.points) {
    const auto raw = *plan.grid.raw(g.positions[i]);
    for (int axis = 0; axis < 3; ++axis) {
      const double value = raw[axis] * plan.grid.scale[axis] + plan.grid.offset[axis];
      low[axis] = std::min(low[axis], value);
      high[axis] = std::max(high[axis], value);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::byte* h = plan.header.data();
    store(h + kScale + 8 * axis, plan.grid.scale[axis]);
    store(h + kOffset + 8 * axis, plan.grid.offset[axis]);
    store(h + kBounds + 16 * axis, high[axis]);
    store(h + kBounds + 16 * axis + 8, low[axis]);
  }
}

// Points in all, and of return number 1, 2, ...; the fields before 1.4 hold 32 bits and know formats 0 to 5 only.
void store_counts(Plan& plan) {
  std::array<std::uint64_t, 16> by_return{};
  const auto returns = std::find_if(plan.targets.begin(), plan.targets.end(),
                                    [](const Target& t) { return t.field.name == "return_number"; });
  const unsigned blank = static_cast<unsigned>(plan.blank[14]) & 7u;
  for (const Index i : plan.points) {
    ++by_return[returns == plan.targets.end() ? blank : static_cast<std::size_t>(returns->column->as_double(i))];
  }
  std::byte* h = plan.header.data();
  const bool has_legacy = plan.point_format < 6 && plan.points.size() <= 0xFFFFFFFFu;
  store(h + kLegacyCount, static_cast<std::uint32_t>(has_legacy ? plan.points.size() : 0));
  for (std::size_t r = 0; r < 5; ++r) {
    store(h + kLegacyReturns + 4 * r, static_cast<std::uint32_t>(has_legacy ? by_return[r + 1] : 0));
  }
  if (!plan.is_14()) return;
  store(h + kCount, std::uint64_t{plan.points.size()});
  for (std::size_t r = 0; r < 15; ++r) store(h + kReturns + 8 * r, by_return[r + 1]);
}

void fill_header(const Geometry& g, std::uint32_t num_vlrs, Plan& plan) {
  std::byte* h = plan.header.data();
  store(h + kHeaderSize, static_cast<std::uint16_t>(plan.header.size()));
  store(h + kPointsOffset, static_cast<std::uint32_t>(plan.header.size() + plan.vlrs.size()));
  store(h + kNumVlrs, num_vlrs);
  store(h + kPointFormat, plan.point_format);
  store(h + kRecordLength, static_cast<std::uint16_t>(plan.stride));
  // Wave forms and extended records are not carried along, so nothing may point to them.
  const auto encoding = load<std::uint16_t>(h + kGlobalEncoding);
  store(h + kGlobalEncoding, static_cast<std::uint16_t>(encoding & ~0x2u));
  if (plan.header.size() >= kEvlrStart) store(h + kWaveformStart, std::uint64_t{0});
  if (plan.is_14()) {
    store(h + kEvlrStart, std::uint64_t{0});
    store(h + kNumEvlrs, std::uint32_t{0});
  }
  store_bounds(g, plan);
  store_counts(plan);
}

Plan make_plan(const Geometry& g, DroppedAttributes& dropped) {
  Plan plan;
  const bool keeps_header = g.las && g.las->header.size() >= kMinHeaderSize && g.las->point_format <= kMaxPointFormat;
  plan.header = keeps_header ? g.las->header : fresh_header();
  plan.point_format = keeps_header ? g.las->point_format : fresh_point_format(g.attributes);
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.positions[i].allFinite()) plan.points.push_back(static_cast<Index>(i));
  }
  if (plan.points.empty()) throw InvalidInput("las: no point has finite coordinates, expected at least one");
  if (keeps_header) plan.grid = {g.las->scale, g.las->offset};
  if (!keeps_header || !reaches_all(plan.grid, g, plan.points)) plan.grid = fresh_grid(g);
  if (!reaches_all(plan.grid, g, plan.points)) throw InvalidInput("las: coordinates too large for 32-bit steps");
  plan.stride = point_size(plan.point_format);
  place_columns(g, plan, dropped);
  plan.blank.resize(plan.stride);
  if (g.attributes.find("return_number") == nullptr && g.attributes.find("number_of_returns") == nullptr) {
    plan.blank[14] = plan.point_format < 6 ? std::byte{0x09} : std::byte{0x11};  // the only return of its pulse
  }
  fill_header(g, build_vlrs(g, keeps_header, plan), plan);
  if (plan.points.size() < g.size()) {
    dropped.push_back(fmt::format("{} points without finite coordinates", g.size() - plan.points.size()));
  }
  if (!g.triangles.empty()) dropped.emplace_back("triangles");
  for (const Column& column : g.triangle_attributes.columns()) dropped.push_back(column.name);
  return plan;
}

}  // namespace

DroppedAttributes write_las(OutputFile& out, const Geometry& geometry, const WriteOptions&) {
  DroppedAttributes dropped;
  const Plan plan = make_plan(geometry, dropped);
  out.write(plan.header.data(), plan.header.size());
  out.write(plan.vlrs.data(), plan.vlrs.size());
  std::vector<std::byte> buffer;
  for (const Index i : plan.points) {
    const std::size_t begin = buffer.size();
    buffer.insert(buffer.end(), plan.blank.begin(), plan.blank.end());
    std::byte* record = buffer.data() + begin;
    const auto raw = *plan.grid.raw(geometry.positions[i]);
    for (int axis = 0; axis < 3; ++axis) store(record + 4 * axis, raw[axis]);
    put_values(plan, i, record);
    if (buffer.size() < kFlushBytes) continue;
    out.write(buffer.data(), buffer.size());
    buffer.clear();
  }
  out.write(buffer.data(), buffer.size());
  return dropped;
}

}  // namespace shapelight::io
