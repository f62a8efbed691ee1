#include "io/file_support.hpp"

namespace shapelight::io::test {
namespace {

const std::filesystem::path kData = SHAPELIGHT_DATA_DIR;

// 2 columns of 3 rows; the file goes down the columns. The second pixel of the first column saw nothing.
constexpr std::string_view kScan =
    "2\n3\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n"
    "1 0 0 0.5 255 0 0\n0 0 0 0 0 0 0\n2 0 0 0.5 0 1 0\n3 1 0 0.25 0 0 1\n4 0 0 1 0 0 0\n5 0 5 1 0 0 0\n";

TEST(Ptx, PutsTheGridIntoRowsAndAppliesTheMatrix) {
  const Geometry scan = read_text(read_ptx, kScan);
  ASSERT_TRUE(scan.grid);
  EXPECT_EQ(scan.grid->width, 2u);
  EXPECT_EQ(scan.grid->height, 3u);
  EXPECT_EQ(scan.grid->pixel, (std::vector<Index>{0, 2, kNoIndex, 3, 1, 4}));
  // Rows of the matrix multiply from the left: x goes to y, y to -x, then the translation.
  EXPECT_EQ(scan.positions,
            (std::vector<Vec3>{{100, 201, 300}, {100, 202, 300}, {99, 203, 300}, {100, 204, 300}, {100, 205, 305}}));
  EXPECT_EQ(*scan.viewpoint, Vec3(1, 2, 3));
  EXPECT_EQ(column(scan, "intensity"), (std::vector<double>{0.5, 0.5, 0.25, 1, 1}));
  EXPECT_EQ(scan.attributes.find("red")->type(), ScalarType::UInt8);
  EXPECT_EQ(scan.kind(), GeometryKind::RangeImage);
}

TEST(Ptx, JoinsSeveralScansWithoutAGrid) {
  const Geometry scans = read_text(read_ptx, std::string(kScan) + "\n" + std::string(kScan));
  EXPECT_EQ(scans.size(), 10u);
  EXPECT_FALSE(scans.grid);
  EXPECT_FALSE(scans.viewpoint);
  ASSERT_EQ(scans.warnings.size(), 1u);
  EXPECT_TRUE(contains(scans.warnings[0], "2 scans"));
}

TEST(Ptx, ReadsARealScan) {
  const Geometry scan = read_path(read_ptx, kData / "clouds/1.2-with-color.ptx");
  EXPECT_EQ(scan.size(), 1065u);
  EXPECT_EQ(scan.positions[0], Vec3(637012.24, 849028.31, 431.66));
  EXPECT_EQ(scan.grid->width, 15u);
  EXPECT_EQ(scan.grid->pixel[0], 0u);
  EXPECT_EQ(scan.grid->pixel[1], 71u);
  EXPECT_EQ(scan.attributes.find("green")->as_double(1), 66.0);
}

TEST(Ptx, RefusesWithTheLine) {
  const std::string scan(kScan);
  EXPECT_TRUE(contains(error_of(read_ptx, scan.substr(0, scan.size() - 14)),
                       "line 15: the file ends, expected 6 points, found 5"));
  EXPECT_TRUE(contains(error_of(read_ptx, "99999\n99999\n" + scan.substr(4)), "do not fit into"));
  EXPECT_TRUE(contains(error_of(read_ptx, "0\n3\n" + scan.substr(4)), "line 1: the number of columns is 0"));
  EXPECT_TRUE(contains(error_of(read_ptx, scan + "7\n"), "line 17: the file ends, expected the number of rows"));
  EXPECT_TRUE(
      contains(error_of(read_ptx, "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0 0 0 0\n"),
               "without a measured point"));
  EXPECT_TRUE(
      contains(error_of(read_ptx, "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 4 5\n"),
               "line 11: 5 numbers"));
}

// 2 rows of 3 pixels, of which two are valid.
constexpr std::string_view kOsu =
    "2 rows\n3 columns\npixels (flag X Y Z):\n0 1 0 0 0 1\n-999999.000000 1 0 0 0 4\n-999999.000000 2 0 0 0 5\n"
    "-999999.000000 3 0 0 0 6.5\n";
constexpr std::string_view kRif =
    "made by hand\nunits mm\n|\nfloat ascii 2 3\n0 1 0 0 0 4\n0 2 0 0 0 5\n0 3 0 0 0 6.5\n1 0 1 1 1 0\n";

TEST(RangeText, ReadsBothFormatsAlikeThoughTheirFlagsDiffer) {
  for (const Geometry& image : {read_text(read_osu, kOsu), read_text(read_rif, kRif)}) {
    EXPECT_EQ(image.positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6.5}}));
    ASSERT_TRUE(image.grid);
    EXPECT_EQ(image.grid->width, 3u);
    EXPECT_EQ(image.grid->height, 2u);
    EXPECT_EQ(image.grid->pixel, (std::vector<Index>{kNoIndex, 0, kNoIndex, kNoIndex, kNoIndex, 1}));
    EXPECT_FALSE(image.viewpoint);
  }
  EXPECT_EQ(read_text(read_rif, kRif).comments, (std::vector<std::string>{"made by hand", "units mm"}));
}

TEST(RangeText, ReadsARealRif) {
  const Geometry image = read_path(read_rif, kData / "scans/bun000_quarter.rif");
  EXPECT_EQ(image.size(), 2524u);
  EXPECT_EQ(image.grid->width, 128u);
  EXPECT_EQ(image.grid->height, 100u);
}

TEST(RangeText, RefusesWithThePlace) {
  const std::string osu(kOsu), rif(kRif);
  const auto replaced = [](std::string text, std::string_view from, std::string_view to) {
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_TRUE(contains(error_of(read_osu, replaced(osu, "2 rows", "2000000000 rows")), "as the"));
  EXPECT_TRUE(contains(error_of(read_osu, replaced(osu, "2 rows", "-2 rows")), "-2 rows"));
  EXPECT_TRUE(contains(error_of(read_osu, replaced(osu, "rows", "lines")), "line 1"));
  EXPECT_TRUE(contains(error_of(read_osu, replaced(osu, "0 1 0", "0 2 0")), "line 4: flag 2 of pixel 1"));
  EXPECT_TRUE(contains(error_of(read_osu, replaced(osu, " 6.5", "    ")), "the file ends"));
  EXPECT_TRUE(contains(error_of(read_osu, osu + "7\n"), "text behind"));
  EXPECT_TRUE(contains(error_of(read_osu, replaced(osu, "6.5", "nan")), "row 1, column 2"));
  EXPECT_TRUE(contains(error_of(read_rif, replaced(rif, "ascii", "binary")), "line 4: only 'float ascii R C'"));
  EXPECT_TRUE(contains(error_of(read_rif, replaced(rif, "|", "-")), "expected a line '|'"));
  EXPECT_TRUE(contains(error_of(read_rif, replaced(rif, "1 0 1 1 1 0", "1 1 1 1 1 1")), "no pixel is valid"));
  EXPECT_TRUE(contains(error_of(read_rif, replaced(rif, "1 0 1 1 1 0", "1 0 1 1 1 x")), "line 8: 'x'"));
}

}  // namespace
}  // namespace shapelight::io::test
