#include "core/parallel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"

namespace shapelight {
namespace {

constexpr int kThreadCounts[] = {0, 1, 2, 3, 8};

RunContext with_threads(int threads) {
  RunContext context;
  context.max_threads = threads;
  return context;
}

TEST(Parallel, ChunksCoverEverythingOnce) {
  for (const int threads : kThreadCounts) {
    for (const std::size_t count : {0u, 1u, 2047u, 2048u, 2049u, 100001u}) {
      std::vector<int> visits(count, 0);
      parallel::for_chunks(with_threads(threads), count, [&](std::size_t begin, std::size_t end) {
        ASSERT_LT(begin, end);
        ASSERT_LE(end - begin, parallel::kDefaultChunk);
        ASSERT_EQ(begin % parallel::kDefaultChunk, 0u);
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " items, " << threads << " threads";
    }
  }
}

TEST(Parallel, SumHasTheSameBitsForAnyNumberOfThreads) {
  testing::expect_same_for_any_number_of_threads([](const RunContext& context) {
    return parallel::sum(context, 300000, [](std::size_t i) { return std::exp(30.0 * random01(1, 0, i)); });
  });
}

TEST(Parallel, PartsAreJoinedInOrder) {
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < 1000; ++i) expected.push_back(10 * i);
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    const auto begins = parallel::reduce_chunks(
        context, 10000, std::vector<std::size_t>{}, [](std::size_t begin, std::size_t) { return std::vector{begin}; },
        [](std::vector<std::size_t> all, const std::vector<std::size_t>& part) {
          all.insert(all.end(), part.begin(), part.end());
          return all;
        },
        10);
    EXPECT_EQ(begins, expected);
    return begins;
  });
}

TEST(Parallel, ExceptionsReachTheCaller) {
  for (const int threads : kThreadCounts) {
    EXPECT_THROW(parallel::for_chunks(with_threads(threads), 100000,
                                      [](std::size_t begin, std::size_t) {
                                        if (begin > 50000) throw InvalidInput("chunk");
                                      }),
                 InvalidInput)
        << threads;
  }
}

TEST(Parallel, AStopRequestEndsInCancelled) {
  for (const int threads : kThreadCounts) {
    std::stop_source stop;
    RunContext context = with_threads(threads);
    context.stop = stop.get_token();
    EXPECT_THROW(parallel::for_chunks(context, 1000000, [&](std::size_t, std::size_t) { stop.request_stop(); }), Cancelled)
        << threads;
    bool ran = false;
    EXPECT_THROW(parallel::for_chunks(context, 1, [&](std::size_t, std::size_t) { ran = true; }), Cancelled);
    EXPECT_FALSE(ran);
  }
}

TEST(Parallel, LoopsMayBeNested) {
  for (const int threads : kThreadCounts) {
    const RunContext context = with_threads(threads);
    std::vector<double> sums(16);
    parallel::for_chunks(
        context, sums.size(),
        [&](std::size_t begin, std::size_t) {
          sums[begin] = parallel::sum(context, 5000, [](std::size_t i) { return static_cast<double>(i); });
        },
        1);
    EXPECT_EQ(sums, std::vector<double>(16, 5000.0 * 4999.0 / 2.0));
  }
}

TEST(RunContext, PhasesMapTheirFractions) {
  std::vector<std::pair<double, std::string>> seen;
  RunContext context;
  context.progress = [&](double fraction, std::string_view name) { seen.emplace_back(fraction, name); };
  const RunContext outer = context.phase(0.5, 1.0, "outer");
  outer.report(0.5);
  outer.phase(0.5, 1.0, "inner").report(1.0);
  EXPECT_EQ(seen, (std::vector<std::pair<double, std::string>>{{0.5, "outer"}, {0.75, "outer"}, {0.75, "inner"}, {1.0, "inner"}}));
}

TEST(RunContext, APhaseOfAStoppedRunThrows) {
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  EXPECT_NO_THROW((void)context.phase(0, 1, "first"));
  stop.request_stop();
  EXPECT_THROW((void)context.phase(0, 1, "second"), Cancelled);
}

TEST(Random, IsAFunctionOfItsArgumentsAndUniform) {
  EXPECT_EQ(random_bits(1, 2, 3), random_bits(1, 2, 3));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(2, 2, 3));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(1, 3, 3));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(1, 2, 4));
  double sum = 0.0;
  std::vector<int> bins(10, 0);
  for (std::uint64_t i = 0; i < 100000; ++i) {
    const double x = random01(0, 0, i);
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    sum += x;
    ++bins[static_cast<std::size_t>(10.0 * x)];
  }
  EXPECT_NEAR(sum / 100000.0, 0.5, 0.005);
  for (const int count : bins) EXPECT_NEAR(count, 10000, 500);
}

}  // namespace
}  // namespace shapelight
