#include "shapelight/core/options.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>

#include "shapelight/core/error.hpp"
#include "shapelight/pipeline/sample.hpp"

namespace shapelight {
namespace {

struct Toy {
  double width = 1.0;
  int steps = 3;
  bool fast = true;
  template <class Self, class Visitor>
  static void describe(Self& o, Visitor&& visit) {
    visit(OptionInfo{"width", "input length units", "Width.", 0, 10}, o.width);
    visit(OptionInfo{"steps", "rings", "Steps.", 1, 5}, o.steps);
    visit(OptionInfo{"fast", "", "Fast."}, o.fast);
  }
};

std::string error_of(const Toy& toy) {
  try {
    validate_options(toy);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(Options, NumbersAreCheckedAgainstTheirRange) {
  EXPECT_EQ(error_of({}), "");
  EXPECT_EQ(error_of({.width = 0.0, .steps = 5}), "");
  EXPECT_EQ(error_of({.width = 11.0}), "--width: 11 is out of range, expected 0 .. 10 [input length units]");
  EXPECT_EQ(error_of({.steps = 0}), "--steps: 0 is out of range, expected 1 .. 5 [rings]");
  EXPECT_NE(error_of({.width = std::nan("")}), "");
  EXPECT_NE(error_of({.width = HUGE_VAL}), "");
}

TEST(Options, EnumsHaveNames) {
  EXPECT_EQ(enum_name(SamplingMethod::Covariance), "covariance");
  EXPECT_EQ(enum_name(Preset::Detail), "detail");
  EXPECT_EQ(enum_name(static_cast<Preset>(99)), "?");
}

// One flat list of flags comes from the table: a name may occur once, and every default must be allowed.
TEST(Options, TheTableOfSampleIsSound) {
  std::set<std::string> names;
  const SampleOptions options;
  SampleOptions::describe(options, [&]<class Member>(const OptionInfo& info, const Member&) {
    EXPECT_TRUE(names.insert(std::string(info.name)).second) << info.name << " occurs twice";
    EXPECT_FALSE(info.meaning.empty()) << info.name;
    if constexpr (std::is_arithmetic_v<Member> && !std::is_same_v<Member, bool>) {
      EXPECT_LT(info.min, info.max) << info.name;
    }
  });
  for (const Preset preset : {Preset::Detail, Preset::Fast, Preset::Paper}) {
    EXPECT_NO_THROW(validate_options(sample_preset(preset)));
  }
}

TEST(Errors, HaveTheExitCodesOfTheInterface) {
  EXPECT_EQ(InvalidInput("").exit_code(), 2);
  EXPECT_EQ(ReadError("").exit_code(), 3);
  EXPECT_EQ(FormatError("").exit_code(), 4);
  EXPECT_EQ(TargetUnreachable("", 12).exit_code(), 5);
  EXPECT_EQ(TargetUnreachable("", 12).reachable(), 12u);
  EXPECT_EQ(BudgetExceeded("").exit_code(), 7);
  EXPECT_EQ(WriteError("").exit_code(), 8);
  EXPECT_EQ(Cancelled().exit_code(), 130);
}

}  // namespace
}  // namespace shapelight
