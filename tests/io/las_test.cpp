#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "io/las_layout.hpp"
#include "io/scalar_bytes.hpp"
#include "point_files.hpp"

namespace shapelight {
namespace {

using namespace io::las;
using test::expect_same;
using test::TempFolder;

template <class T>
void put(std::string& file, std::size_t offset, T value) {
  io::store(reinterpret_cast<std::byte*>(file.data()) + offset, value);
}
template <class T>
T get(const std::string& file, std::size_t offset) {
  return io::load<T>(reinterpret_cast<const std::byte*>(file.data()) + offset);
}

// Three points whose record bytes count up from the point's number, with no records before them.
std::string counting_file(std::uint8_t format, std::size_t extra_bytes = 0, const std::string& vlrs = "") {
  const std::size_t header = format >= 6 ? kHeaderSize14 : kEvlrStart;
  const std::size_t stride = point_size(format) + extra_bytes;
  std::string file(header, '\0');
  file.replace(0, 4, "LASF");
  put<std::uint8_t>(file, kVersionMinor - 1, 1);
  put<std::uint8_t>(file, kVersionMinor, format >= 6 ? 4 : 3);
  put(file, kHeaderSize, static_cast<std::uint16_t>(header));
  put(file, kPointsOffset, static_cast<std::uint32_t>(header + vlrs.size()));
  put<std::uint32_t>(file, kNumVlrs, vlrs.empty() ? 0 : 1);
  put(file, kPointFormat, format);
  put(file, kRecordLength, static_cast<std::uint16_t>(stride));
  put<std::uint32_t>(file, kLegacyCount, format >= 6 ? 0 : 3);
  if (format >= 6) put<std::uint64_t>(file, kCount, 3);
  for (int axis = 0; axis < 3; ++axis) {
    put(file, kScale + 8 * axis, 0.01);
    put(file, kOffset + 8 * axis, 1000.0 * (axis + 1));
  }
  file += vlrs;
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t b = 0; b < stride; ++b) file += static_cast<char>(p * 16 + b);
  }
  return file;
}

std::string points_of(const std::string& file) { return file.substr(get<std::uint32_t>(file, kPointsOffset)); }

std::string extra_bytes_vlr(const std::vector<std::pair<std::string, std::uint8_t>>& dimensions) {
  std::string payload;
  for (const auto& [name, code] : dimensions) {
    std::string descriptor(kExtraDescriptorSize, '\0');
    descriptor[2] = static_cast<char>(code);
    descriptor.replace(4, name.size(), name);
    descriptor.replace(160, 4, "unit");
    payload += descriptor;
  }
  std::string head(kVlrHeaderSize, '\0');
  head.replace(2, 9, "LASF_Spec");
  put(head, 18, kExtraBytesRecord);
  put(head, 20, static_cast<std::uint16_t>(payload.size()));
  return head + payload;
}

TEST(Las, EveryPointFormatRoundTripsByteForByte) {
  const TempFolder folder;
  for (std::uint8_t format = 0; format <= kMaxPointFormat; ++format) {
    const std::string file = counting_file(format);
    const Geometry g = read_geometry(folder.file("a.las", file));
    EXPECT_TRUE(g.warnings.empty());
    EXPECT_TRUE(write_geometry(folder.file("b.las"), g, {.overwrite = true}).empty());
    const std::string back = test::contents_of(folder.file("b.las"));
    EXPECT_EQ(points_of(file), points_of(back)) << int{format};
    const Geometry again = read_geometry(folder.file("b.las"));
    expect_same(g, again);
    EXPECT_EQ(again.las->scale, g.las->scale);
    EXPECT_EQ(again.las->point_format, format);
  }
}

TEST(Las, BitFieldsOfOldFormats) {
  const TempFolder folder;
  std::string file = counting_file(3);
  const std::size_t point = get<std::uint32_t>(file, kPointsOffset);
  put<std::int32_t>(file, point, -5);
  put<std::uint8_t>(file, point + 14, 0b10'011'010);
  put<std::uint8_t>(file, point + 15, 0b101'00010);
  put<std::int8_t>(file, point + 16, -12);
  put<std::uint16_t>(file, point + 28, 0xABCD);
  const Geometry g = read_geometry(folder.file("a.las", file));
  const std::map<std::string, double> expected = {{"return_number", 2},
                                                  {"number_of_returns", 3},
                                                  {"scan_direction_flag", 0},
                                                  {"edge_of_flight_line", 1},
                                                  {"classification", 2},
                                                  {"synthetic", 1},
                                                  {"keypoint", 0},
                                                  {"withheld", 1},
                                                  {"scan_angle", -12},
                                                  {"red", 0xABCD}};
  for (const auto& [name, value] : expected) EXPECT_EQ(g.attributes.find(name)->as_double(0), value) << name;
  EXPECT_EQ(g.positions[0].x(), -5 * 0.01 + 1000.0);
}

TEST(Las, BitFieldsOfNewFormats) {
  const TempFolder folder;
  std::string file = counting_file(6);
  const std::size_t point = get<std::uint32_t>(file, kPointsOffset);
  put<std::uint8_t>(file, point + 14, 0x5E);
  put<std::uint8_t>(file, point + 15, 0b01'10'1001);
  put<std::uint8_t>(file, point + 16, 200);
  put<std::int16_t>(file, point + 18, -30000);
  const Geometry g = read_geometry(folder.file("a.las", file));
  const std::map<std::string, double> expected = {{"return_number", 14},
                                                  {"number_of_returns", 5},
                                                  {"synthetic", 1},
                                                  {"keypoint", 0},
                                                  {"withheld", 0},
                                                  {"overlap", 1},
                                                  {"scanner_channel", 2},
                                                  {"scan_direction_flag", 1},
                                                  {"edge_of_flight_line", 0},
                                                  {"classification", 200},
                                                  {"scan_angle", -30000}};
  for (const auto& [name, value] : expected) EXPECT_EQ(g.attributes.find(name)->as_double(0), value) << name;
}

TEST(Las, ExtraBytesKeepTheirDescriptors) {
  const TempFolder folder;
  const std::string vlr = extra_bytes_vlr({{"height", 9}, {"number", 7}, {"pair", 13}});
  const std::string file = counting_file(1, 4 + 8 + 4, vlr);
  const Geometry g = read_geometry(folder.file("a.las", file));
  EXPECT_EQ(g.attributes.find("height")->type(), ScalarType::Float32);
  EXPECT_EQ(g.attributes.find("number")->type(), ScalarType::UInt64);
  EXPECT_EQ(g.attributes.find("pair_1")->type(), ScalarType::UInt16);
  (void)write_geometry(folder.file("b.las"), g);
  const std::string back = test::contents_of(folder.file("b.las"));
  EXPECT_EQ(points_of(file), points_of(back));
  EXPECT_EQ(back.substr(kEvlrStart + kVlrHeaderSize, 2 * kExtraDescriptorSize),
            file.substr(kEvlrStart + kVlrHeaderSize, 2 * kExtraDescriptorSize));
  expect_same(g, read_geometry(folder.file("b.las")));
}

TEST(Las, UndocumentedBytesAreSkippedWithAWarning) {
  const TempFolder folder;
  const Geometry g = read_geometry(folder.file("a.las", counting_file(0, 5)));
  EXPECT_EQ(g.warnings, std::vector<std::string>{"5 undocumented bytes per point skipped"});
}

TEST(Las, RealFilesRoundTrip) {
  const TempFolder folder;
  for (const char* name : {"clouds/simple.las", "clouds/autzen_trim.las"}) {
    const Geometry g = read_geometry(test::data_file(name));
    (void)write_geometry(folder.file("a.las"), g, {.overwrite = true});
    const std::string file = test::contents_of(test::data_file(name));
    const std::string back = test::contents_of(folder.file("a.las"));
    EXPECT_EQ(points_of(file).substr(0, points_of(back).size()), points_of(back)) << name;
    expect_same(g, read_geometry(folder.file("a.las")));
    EXPECT_EQ(file.substr(kLegacyReturns, 20), back.substr(kLegacyReturns, 20));
    EXPECT_EQ(g.las->vlrs, read_geometry(folder.file("a.las")).las->vlrs);
  }
}

TEST(Las, SubsetUpdatesCountsAndBounds) {
  const TempFolder folder;
  const Geometry all = read_geometry(test::data_file("clouds/simple.las"));
  const std::vector<Index> few = {3, 10, 700};
  const Geometry some = select_points(all, few);
  (void)write_geometry(folder.file("a.las"), some);
  const std::string file = test::contents_of(folder.file("a.las"));
  EXPECT_EQ(get<std::uint32_t>(file, kLegacyCount), 3u);
  std::uint32_t num_returns = 0;
  for (int r = 0; r < 5; ++r) num_returns += get<std::uint32_t>(file, kLegacyReturns + 4 * r);
  EXPECT_EQ(num_returns, 3u);
  const BoundingBox box = bounding_box(some.positions);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(get<double>(file, kBounds + 16 * axis), box.max[axis]);
    EXPECT_EQ(get<double>(file, kBounds + 16 * axis + 8), box.min[axis]);
  }
  expect_same(some, read_geometry(folder.file("a.las")));
}

TEST(Las, ThroughPlyKeepsUtmPrecision) {
  const TempFolder folder;
  const Geometry g = read_geometry(test::data_file("clouds/simple.las"));
  (void)write_geometry(folder.file("a.ply"), g);
  const Geometry ply = read_geometry(folder.file("a.ply"));
  expect_same(g, ply);
  (void)write_geometry(folder.file("b.las"), ply);
  const Geometry back = read_geometry(folder.file("b.las"));
  const double size = bounding_box(g.positions).diagonal();
  for (std::size_t i = 0; i < g.size(); ++i) {
    EXPECT_LE((back.positions[i] - g.positions[i]).cwiseAbs().maxCoeff(), 1e-8 * size);
  }
  EXPECT_EQ(back.attributes.find("gps_time")->to_doubles(), g.attributes.find("gps_time")->to_doubles());
  EXPECT_EQ(back.attributes.find("scan_angle")->as_double(0),
            std::round(g.attributes.find("scan_angle")->as_double(0) / 0.006));
}

TEST(Las, FreshHeaderForOtherInputs) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{1e-3, 2e-3, 0}, {4e-3, 0, 1e-3}, {NAN, 0, 0}};
  g.attributes.set({"red", std::vector<std::uint8_t>{255, 1, 0}});
  g.attributes.set(
      {"intensity", std::vector<float>{0.5f, 7.0f, 0}});  // no 16-bit integer: keeps its values as an extra
  g.attributes.set({"classification", std::vector<std::int32_t>{2, 255, 0}});
  g.attributes.set({"shape_index", std::vector<double>{-0.25, NAN, 0}});
  EXPECT_EQ(write_geometry(folder.file("a.las"), g), std::vector<std::string>{"1 points without finite coordinates"});
  const Geometry back = read_geometry(folder.file("a.las"));
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back.las->point_format, 7);
  EXPECT_NEAR(back.positions[1].x(), 4e-3, 1e-11);
  EXPECT_EQ(back.attributes.find("red")->to_doubles(), (std::vector<double>{65535, 257}));
  EXPECT_EQ(back.attributes.find("classification")->to_doubles(), (std::vector<double>{2, 255}));
  EXPECT_EQ(back.attributes.find("intensity_value")->to_doubles(), (std::vector<double>{0.5, 7.0}));
  EXPECT_EQ(back.attributes.find("shape_index")->as_double(0), -0.25);
  EXPECT_EQ(back.attributes.find("return_number")->to_doubles(), (std::vector<double>{1, 1}));
  const std::string file = test::contents_of(folder.file("a.las"));
  EXPECT_EQ(get<std::uint64_t>(file, kCount), 2u);
  EXPECT_EQ(get<std::uint64_t>(file, kReturns), 2u);
}

TEST(Las, PointsOutOfReachGetANewGrid) {
  const TempFolder folder;
  Geometry g = read_geometry(test::data_file("clouds/simple.las"));
  for (Vec3& p : g.positions) p.x() += 1e9;
  (void)write_geometry(folder.file("a.las"), g);
  const Geometry back = read_geometry(folder.file("a.las"));
  EXPECT_NE(back.las->offset, g.las->offset);
  EXPECT_NEAR(back.positions[5].x(), g.positions[5].x(), 1e-4);
}

TEST(Las, UnusableGeometryIsInvalidInput) {
  const TempFolder folder;
  Geometry g;
  g.positions = {{NAN, 0, 0}};
  EXPECT_THROW((void)write_geometry(folder.file("a.las"), g), InvalidInput);
  g.positions = {{-1e308, 0, 0}, {1e308, 0, 0}};
  EXPECT_THROW((void)write_geometry(folder.file("a.las"), g), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.las")));
}

TEST(Las, RefusesWithThePlace) {
  const TempFolder folder;
  const std::string good = counting_file(6);
  const auto with = [&](std::size_t offset, auto value) {
    std::string bad = good;
    put(bad, offset, value);
    return bad;
  };
  const std::vector<std::array<std::string, 2>> cases = {
      {good.substr(0, 200), "a header of 227 bytes expected, the file has 200"},
      {"NOPE" + good.substr(4), "expected LASF"},
      {with(kVersionMinor, std::uint8_t{9}), "version 1.9"},
      {with(kHeaderSize, std::uint16_t{227}), "a header of 227 bytes"},
      {with(kPointsOffset, std::uint32_t{4000000000u}), "points from byte 4000000000"},
      {with(kPointFormat, std::uint8_t{11}), "point format 11, expected 0 to 10"},
      {with(kPointFormat, std::uint8_t{0x86}), "compressed (LAZ)"},
      {with(kRecordLength, std::uint16_t{29}), "records of 29 bytes, expected at least 30"},
      {with(kRecordLength, std::uint16_t{31}), "3 points of 31 bytes expected, 90 bytes left"},
      {with(kCount, std::uint64_t{4}), "4 points of 30 bytes expected"},
      {with(kCount, std::uint64_t{1} << 60), "expected at most"},
      {with(kCount, std::uint64_t{0}), "0 points"},
      {with(kScale, 0.0), "scale"},
      {with(kOffset, std::numeric_limits<double>::quiet_NaN()), "offset"},
      {with(kNumVlrs, std::uint32_t{1}), "variable length record 1 of 1"},
      {counting_file(0, 2, extra_bytes_vlr({{"height", 9}})),
       "extra dimensions need 24 bytes per point, expected at most 22"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string message = test::refusal(folder.file("bad.las", text));
    EXPECT_NE(message.find(expected), std::string::npos) << expected << ": " << message;
  }
}

}  // namespace
}  // namespace shapelight
