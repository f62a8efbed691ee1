#include "pipeline/simplify_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "shapelight/core/error.hpp"

// The search for the coarsest count within an error, on errors in closed form.
namespace shapelight::pipeline {
namespace {

TEST(FindCount, PowersOfTheCountAreFoundWithinTheirPrecision) {
  for (const double power : {0.5, 1.0, 2.0}) {
    for (const double bound : {1e-1, 1e-2, 1e-3}) {
      for (const std::size_t guess : {50u, 1000u, 40000u}) {
        const auto error = [&](std::size_t n) { return std::pow(static_cast<double>(n) / 10.0, -power); };
        const double exact = 10.0 * std::pow(bound, -1.0 / power);
        const CountSearch search{.least = 4, .most = 100000, .guess = guess, .max_tries = 12};
        if (exact > 100000.0) {
          EXPECT_THROW((void)find_count(bound, search, error), TargetUnreachable);
          continue;
        }
        const FoundCount found = find_count(bound, search, error);
        EXPECT_LE(found.error, bound);
        EXPECT_EQ(found.error, error(found.count));
        EXPECT_LE(static_cast<double>(found.count), std::max(exact * 1.03, exact + 1.0)) << power << " " << bound << " " << guess;
      }
    }
  }
}

TEST(FindCount, FewTriesDoFromAFairGuess) {
  std::size_t tries = 0;
  const FoundCount found = find_count(0.01, {.least = 4, .most = 1000000, .guess = 1500}, [&](std::size_t n) {
    ++tries;
    return 10.0 / static_cast<double>(n);  // 1000
  });
  EXPECT_EQ(tries, found.tries);
  EXPECT_LE(tries, 5u);
  EXPECT_NEAR(static_cast<double>(found.count), 1000.0, 20.0);
}

TEST(FindCount, ErrorsThatJumpStillEndWithinTheBound) {
  std::size_t tries = 0;
  const auto jumpy = [&](std::size_t n) {
    ++tries;
    return 10.0 / static_cast<double>(n) * (n % 3 == 0 ? 1.4 : n % 3 == 1 ? 0.7 : 1.0);
  };
  for (const double bound : {0.5, 0.05, 0.005}) {
    tries = 0;
    const FoundCount found = find_count(bound, {.least = 4, .most = 100000, .guess = 300}, jumpy);
    EXPECT_LE(found.error, bound);
    EXPECT_LE(tries, 9u);
  }
}

TEST(FindCount, TheLeastReachableCountIsTheEnd) {
  const auto stuck_at_40 = [](std::size_t n) -> double {
    if (n < 40) throw TargetUnreachable("40 at least", 40);
    return 1.0 / static_cast<double>(n);
  };
  EXPECT_EQ(find_count(1.0, {.least = 4, .most = 5000, .guess = 500}, stuck_at_40).count, 40u);
}

TEST(FindCount, NoErrorAtAllAndTooMuchAtAll) {
  EXPECT_EQ(find_count(1.0, {.least = 4, .most = 5000, .guess = 500}, [](std::size_t) { return 0.0; }).count, 4u);
  try {
    (void)find_count(1.0, {.least = 4, .most = 5000, .guess = 500}, [](std::size_t) { return 2.0; });
    ADD_FAILURE() << "expected TargetUnreachable";
  } catch (const TargetUnreachable& error) {
    EXPECT_EQ(error.reachable(), 5000u);
    EXPECT_NE(std::string(error.what()).find("within 2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace shapelight::pipeline
