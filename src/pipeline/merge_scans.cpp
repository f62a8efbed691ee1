#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "shapelight/core/error.hpp"
#include "shapelight/pipeline/align.hpp"

namespace shapelight {
namespace {

Geometry finite_points(const Geometry& scan, const RigidTransform& T_world_scan) {
  std::vector<Index> finite;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.positions[i].allFinite()) finite.push_back(static_cast<Index>(i));
  }
  Geometry points = select_points(scan, finite);
  transform_geometry(points, T_world_scan);
  return points;
}

// Of the columns that both have, in the same type; the others are lost.
void append(AttributeTable& merged, const AttributeTable& more) {
  AttributeTable common;
  for (Column column : merged.columns()) {
    const Column* other = more.find(column.name);
    if (other == nullptr || other->type() != column.type()) continue;
    std::visit(
        [&](auto& values) {
          const auto& added = std::get<std::remove_reference_t<decltype(values)>>(other->values);
          values.insert(values.end(), added.begin(), added.end());
        },
        column.values);
    common.set(std::move(column));
  }
  merged = std::move(common);
}

}  // namespace

Geometry merge_scans(std::span<const Geometry> scans, const AlignResult& aligned, const RunContext& context) {
  if (scans.size() != aligned.scans.size()) {
    throw InvalidInput(fmt::format("merge: {} scans, {} were aligned", scans.size(), aligned.scans.size()));
  }
  Geometry merged;
  std::vector<std::uint32_t> scan_of_point;
  merged.coordinate_type = ScalarType::Float32;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    context.check();
    if (aligned.scans[i].group != 0) continue;
    Geometry points = finite_points(scans[i], aligned.scans[i].T_world_scan);
    if (points.coordinate_type == ScalarType::Float64) merged.coordinate_type = ScalarType::Float64;
    const bool is_first = scan_of_point.empty();
    if (is_first) {
      merged.attributes = std::move(points.attributes);
    } else {
      append(merged.attributes, points.attributes);
    }
    merged.positions.insert(merged.positions.end(), points.positions.begin(), points.positions.end());
    scan_of_point.resize(merged.size(), static_cast<std::uint32_t>(i));
  }
  merged.attributes.set({"scan", std::move(scan_of_point)});
  return merged;
}

}  // namespace shapelight
