#include "values.hpp"

#include <gtest/gtest.h>

#include "shapelight/core/error.hpp"

namespace shapelight::cli {
namespace {

TEST(Values, Counts) {
  EXPECT_EQ(parse_count("count", "1"), 1u);
  EXPECT_EQ(parse_count("count", "1200"), 1200u);
  EXPECT_EQ(parse_count("count", "50k"), 50000u);
  EXPECT_EQ(parse_count("count", "1.5M"), 1500000u);
  EXPECT_EQ(parse_count("count", "1e3"), 1000u);
  for (const char* bad : {"", "0", "-5", "1.5", "abc", "10q", "5 k", "50kk", "nan", "inf", "1e300", "0x10", "5%", " 5"}) {
    EXPECT_THROW((void)parse_count("count", bad), InvalidInput) << bad;
  }
}

TEST(Values, Ratios) {
  EXPECT_EQ(parse_ratio("ratio", "0.1"), 0.1);
  EXPECT_EQ(parse_ratio("ratio", "10%"), 0.1);
  EXPECT_EQ(parse_ratio("ratio", "1"), 1.0);
  EXPECT_EQ(parse_ratio("ratio", "100%"), 1.0);
  for (const char* bad : {"", "0", "0%", "1.5", "101%", "-0.1", "abc", "0.1x", "nan", "inf", "%"}) {
    EXPECT_THROW((void)parse_ratio("ratio", bad), InvalidInput) << bad;
  }
}

TEST(Values, Lengths) {
  EXPECT_EQ(parse_length("spacing", "0.5").resolve(200.0), 0.5);
  EXPECT_EQ(parse_length("spacing", "2%").resolve(200.0), 4.0);
  for (const char* bad : {"", "0", "-1", "5m", "nan", "inf", "0%"}) {
    EXPECT_THROW((void)parse_length("spacing", bad), InvalidInput) << bad;
  }
}

TEST(Values, Bytes) {
  EXPECT_EQ(parse_bytes("max-memory", "1000"), 1000u);
  EXPECT_EQ(parse_bytes("max-memory", "2K"), 2048u);
  EXPECT_EQ(parse_bytes("max-memory", "1.5GiB"), 3u << 29);
  EXPECT_EQ(parse_bytes("max-memory", "800M"), 800u << 20);
  for (const char* bad : {"", "0", "-1", "5x", "nan", "1e30G"}) {
    EXPECT_THROW((void)parse_bytes("max-memory", bad), InvalidInput) << bad;
  }
}

TEST(Values, MessagesNameOptionValueAndExpectation) {
  try {
    (void)parse_ratio("ratio", "1.5");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()),
              "--ratio: '1.5', expected a share to keep, more than 0 and at most 1, such as 0.1 or 10%");
  }
}

}  // namespace
}  // namespace shapelight::cli
