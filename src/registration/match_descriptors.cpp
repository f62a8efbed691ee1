#include "registration/match_descriptors.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/parallel.hpp"
#include "core/vectorize.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kBins = DescribedPoints::kBins;
constexpr std::size_t kLanes = 64;  // points that are compared at once
constexpr std::size_t kChunk = 64;
using Descriptor = std::array<float, kBins>;

/// Descriptors in blocks of kLanes, bin by bin, so that the inner loop runs over points.
std::vector<float> in_blocks(const DescribedPoints& points) {
  std::vector<float> blocks((points.size() + kLanes - 1) / kLanes * kLanes * kBins, 0.0F);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t b = 0; b < kBins; ++b) {
      blocks[(i / kLanes * kBins + b) * kLanes + i % kLanes] = points.descriptor[i * kBins + b];
    }
  }
  return blocks;
}

SHAPELIGHT_VECTORIZE void compare(const float* descriptor, const float* block, float* difference) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) difference[lane] = 0.0F;
  for (std::size_t b = 0; b < kBins; ++b) {
    const float value = descriptor[b];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float d = block[b * kLanes + lane] - value;
      difference[lane] += d * d;
    }
  }
}

/// What the descriptor would be if all normals changed their sign: the second and third angle change theirs.
Descriptor turned(Descriptor descriptor) {
  constexpr auto kAngle = static_cast<std::ptrdiff_t>(kBins / 3);
  std::reverse(descriptor.begin() + kAngle, descriptor.begin() + 2 * kAngle);
  std::reverse(descriptor.begin() + 2 * kAngle, descriptor.end());
  return descriptor;
}

/// The two best points so far; of equal ones those that were offered first.
struct BestTwo {
  struct Entry {
    float difference = std::numeric_limits<float>::max();
    Index index = kNoIndex;
    bool turned = false;
  };
  Entry first, second;

  void offer(const Entry& entry) {
    if (!(entry.difference < second.difference)) return;
    second = entry;
    if (second.difference < first.difference) std::swap(first, second);
  }
};

BestTwo best_two(Descriptor descriptor, std::span<const float> blocks, std::size_t count, bool same_side) {
  BestTwo best;
  std::array<float, kLanes> difference{};
  for (const bool is_turned : {false, true}) {
    if (is_turned && same_side) break;
    if (is_turned) descriptor = turned(descriptor);
    for (std::size_t begin = 0; begin < count; begin += kLanes) {
      compare(descriptor.data(), &blocks[begin * kBins], difference.data());
      const std::size_t lanes = std::min(kLanes, count - begin);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        best.offer({difference[lane], static_cast<Index>(begin + lane), is_turned});
      }
    }
  }
  return best;
}

/// Two matches per keypoint of `from`, as if it were the source.
std::vector<Match> match_one_way(const DescribedPoints& from, const DescribedPoints& to, bool same_side,
                                 const RunContext& context) {
  const std::vector<float> blocks = in_blocks(to);
  std::vector<Match> matches(2 * from.keypoints.size());
  parallel::for_chunks(
      context, from.keypoints.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const Index point = from.keypoints[k];
          Descriptor descriptor;
          std::copy_n(&from.descriptor[point * kBins], kBins, descriptor.begin());
          const BestTwo best = best_two(descriptor, blocks, to.size(), same_side);
          matches[2 * k] = {point, best.first.index, best.first.turned};
          matches[2 * k + 1] = {point, best.second.index, best.second.turned};
        }
      },
      kChunk);
  std::erase_if(matches, [](const Match& match) { return match.target == kNoIndex; });
  return matches;
}

}  // namespace

std::vector<Match> match_descriptors(const DescribedPoints& source, const DescribedPoints& target, bool same_side,
                                     const RunContext& context) {
  std::vector<Match> matches = match_one_way(source, target, same_side, context);
  for (Match match : match_one_way(target, source, same_side, context)) {
    std::swap(match.source, match.target);
    matches.push_back(match);
  }
  std::sort(matches.begin(), matches.end());
  matches.erase(std::unique(matches.begin(), matches.end()), matches.end());
  return matches;
}

}  // namespace shapelight
