#include "shapelight/pipeline/fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapelight/core/error.hpp"
#include "support/data_files.hpp"
#include "support/determinism.hpp"

namespace shapelight {
namespace {

using namespace shapelight::testing;

constexpr Preset kPresets[] = {Preset::Detail, Preset::Fast, Preset::Paper};
constexpr const char* kFiles[] = {"meshes/fandisk.off", "scans/bun000_quarter.rif", "clouds/simple.las"};

// All of a table's values, NaN made comparable.
std::vector<std::vector<double>> values_of(const AttributeTable& table) {
  std::vector<std::vector<double>> all;
  for (const Column& column : table.columns()) {
    all.push_back(column.to_doubles());
    for (double& v : all.back()) v = std::isnan(v) ? 1e300 : v;
  }
  return all;
}

TEST(Fields, ThreadsDoNotMatter) {
  for (const char* file : {"meshes/fandisk.off", "scans/dragonStandRight_0.ply", "clouds/simple.las"}) {
    const Geometry geometry = read_data(file);
    for (const Preset preset : kPresets) {
      SCOPED_TRACE(std::string(file) + " " + std::string(enum_name(preset)));
      expect_same_for_any_number_of_threads([&](const RunContext& context) {
        return values_of(point_fields(geometry, fields_preset(preset), context).attributes);
      });
    }
  }
}

TEST(Fields, ValuesAreInTheirRanges) {
  for (const char* file : kFiles) {
    const Geometry geometry = read_data(file);
    for (const Preset preset : kPresets) {
      SCOPED_TRACE(std::string(file) + " " + std::string(enum_name(preset)));
      const FieldsOptions options = fields_preset(preset);
      const BuiltGraph built = build_graph(geometry, options.graph);
      const SurfaceFields fields = compute_fields(built.graph, geometry.kind(), options);
      const std::size_t n = built.graph.size();
      ASSERT_EQ(fields.shape_index.size(), n);
      ASSERT_EQ(fields.importance.size(), n);
      EXPECT_EQ(fields.reflectance.size(), options.retinex ? n : 0);
      EXPECT_EQ(fields.segment.size(), options.segment ? n : 0);
      EXPECT_EQ(fields.denoised, options.denoise && preset == Preset::Paper);
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_GE(fields.k1[i], fields.k2[i]);
        ASSERT_GE(fields.curvedness[i], 0.0);
        ASSERT_LE(std::abs(fields.shape_index[i]), 1.0);
        ASSERT_GE(fields.surface_variation[i], 0.0);
        ASSERT_LE(fields.surface_variation[i], 1.0 / 3.0 + 1e-12);
        ASSERT_TRUE(std::isfinite(fields.importance[i]) && fields.importance[i] >= 0.0);
        if (options.retinex) {
          ASSERT_LE(std::abs(fields.reflectance[i]), std::numbers::ln2 + 1e-12);
          ASSERT_GE(fields.illumination[i], 0.0);
          ASSERT_LE(fields.illumination[i], 1.0);
        }
        ASSERT_TRUE(!options.segment || fields.segment[i] < fields.num_segments);
      }
    }
  }
}

TEST(Fields, EveryPointHasEveryField) {
  const Geometry geometry = read_data("clouds/simple.las");
  const AttributeTable table = point_fields(geometry, fields_preset(Preset::Detail)).attributes;
  for (const char* name : {"shape_index", "curvedness", "illumination", "reflectance", "segment", "importance"}) {
    ASSERT_NE(table.find(name), nullptr) << name;
    EXPECT_EQ(table.find(name)->size(), geometry.size());
  }
}

TEST(Fields, LostPointsHaveNoValueAndDuplicatesTheirTwins) {
  Geometry geometry = read_data("scans/bun000_quarter.rif");
  geometry = as_cloud(std::move(geometry));
  std::erase_if(geometry.positions, [](const Vec3& p) { return !p.allFinite(); });
  geometry.attributes = {};
  const std::size_t n = geometry.size();
  geometry.positions.push_back(geometry.positions[17]);
  geometry.positions.emplace_back(0.0, std::nan(""), 0.0);
  const AttributeTable table = point_fields(geometry, fields_preset(Preset::Detail)).attributes;
  for (const char* name : {"shape_index", "curvedness", "illumination", "reflectance", "importance"}) {
    EXPECT_EQ(table.find(name)->as_double(n), table.find(name)->as_double(17)) << name;
    EXPECT_TRUE(std::isnan(table.find(name)->as_double(n + 1))) << name;
  }
  EXPECT_EQ(table.find("segment")->as_double(n), table.find("segment")->as_double(17));
  EXPECT_EQ(table.find("segment")->as_double(n + 1), -1.0);
}

TEST(Fields, OrderOfTheInputDoesNotMatter) {
  const Geometry geometry = read_data("meshes/fandisk.off");
  const std::vector<Index> order = random_order(geometry.size(), 3);
  for (const Preset preset : kPresets) {
    const AttributeTable a = point_fields(geometry, fields_preset(preset)).attributes.gather(order);
    const AttributeTable b = point_fields(reordered(geometry, order), fields_preset(preset)).attributes;
    for (const char* name : {"shape_index", "curvedness", "importance"}) {
      EXPECT_TRUE(a.find(name)->values == b.find(name)->values) << name << " " << enum_name(preset);
    }
  }
}

TEST(Fields, NextToNothingIsNoReasonToFail) {
  const std::vector<std::vector<Vec3>> cases = {{},
                                                {{1, 2, 3}},
                                                {{1, 2, 3}, {4, 5, 6}},
                                                std::vector<Vec3>(9, Vec3(1, 2, 3)),
                                                {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}},
                                                {{std::nan(""), 0, 0}}};
  for (const std::vector<Vec3>& positions : cases) {
    Geometry geometry;
    geometry.positions = positions;
    for (const Preset preset : kPresets) {
      const PointFields result = point_fields(geometry, fields_preset(preset));
      EXPECT_EQ(result.attributes.find("importance")->size(), positions.size());
    }
  }
}

TEST(Fields, OptionsAreChecked) {
  const Geometry geometry = read_data("scans/bun000_quarter.rif");
  FieldsOptions options;
  options.variation.neighbors = 1;
  EXPECT_THROW((void)point_fields(geometry, options), InvalidInput);
  options = {};
  options.retinex_options = {};
  options.graph.depth_jump = std::nan("");
  EXPECT_THROW((void)point_fields(geometry, options), InvalidInput);
}

}  // namespace
}  // namespace shapelight
