#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "shapelight/core/run_context.hpp"

/// Deterministic parallel loops. Chunks have a fixed size that does not depend on the number of threads, and partial
/// results are joined in chunk order, so a result never depends on how many threads ran.
namespace shapelight::parallel {

inline constexpr std::size_t kDefaultChunk = 2048;  ///< items per chunk; scratch buffers live as long as one chunk

/// Runs body(chunk) for every chunk in [0, num_chunks); on the caller's thread when there is one chunk or one thread.
/// The caller takes part. Polls the stop token once per chunk and throws Cancelled; the first exception of a body wins.
void run_chunks(const RunContext& context, std::size_t num_chunks, const std::function<void(std::size_t)>& body);

/// Calls body(begin, end) for consecutive ranges of at most `chunk` items. Safe when bodies write to their own items.
template <class Body>
void for_chunks(const RunContext& context, std::size_t count, Body&& body, std::size_t chunk = kDefaultChunk) {
  run_chunks(context, (count + chunk - 1) / chunk,
             [&](std::size_t i) { body(i * chunk, std::min(count, (i + 1) * chunk)); });
}

/// map(begin, end) -> T per chunk, then join(total, part) in chunk order.
template <class T, class Map, class Join>
[[nodiscard]] T reduce_chunks(const RunContext& context, std::size_t count, T total, Map&& map, Join&& join,
                              std::size_t chunk = kDefaultChunk) {
  const std::size_t num_chunks = (count + chunk - 1) / chunk;
  std::vector<T> parts(num_chunks, total);
  run_chunks(context, num_chunks, [&](std::size_t i) { parts[i] = map(i * chunk, std::min(count, (i + 1) * chunk)); });
  for (T& part : parts) total = join(std::move(total), std::move(part));
  return total;
}

/// Sum of value(i) over [0, count), chunk sums added in order: the same bits for any number of threads.
template <class Value>
[[nodiscard]] double sum(const RunContext& context, std::size_t count, Value&& value) {
  return reduce_chunks(
      context, count, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double part = 0.0;
        for (std::size_t i = begin; i < end; ++i) part += value(i);
        return part;
      },
      [](double a, double b) { return a + b; });
}

}  // namespace shapelight::parallel
