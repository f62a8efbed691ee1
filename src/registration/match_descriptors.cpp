#include "registration/match_descriptors.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "core/parallel.hpp"
#include "core/vectorize.hpp"
#include "registration/tune.hpp"

namespace shapelight {
namespace {

constexpr std::size_t kBins = DescribedPoints::kBins;
constexpr std::size_t kLanes = 64;  // targets that are compared at once
constexpr std::size_t kChunk = 64;
using Row = std::array<float, kBins>;

/// Descriptors in blocks of kLanes, bin by bin, so that the inner loop runs over targets.
std::vector<float> in_blocks(const DescribedPoints& points) {
  std::vector<float> blocks((points.size() + kLanes - 1) / kLanes * kLanes * kBins, 1e3F);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t b = 0; b < kBins; ++b) {
      blocks[(i / kLanes * kBins + b) * kLanes + i % kLanes] = points.descriptor[i * kBins + b];
    }
  }
  return blocks;
}

SHAPELIGHT_VECTORIZE void compare(const float* row, const float* block, float* difference) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) difference[lane] = 0.0F;
  for (std::size_t b = 0; b < kBins; ++b) {
    const float value = row[b];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float d = block[b * kLanes + lane] - value;
      difference[lane] += d * d;
    }
  }
}

/// What the descriptor would be had all normals the other sign: the second and third angle change theirs.
Row turned(const Row& row) {
  Row result = row;
  for (std::size_t group = 1; group < 3; ++group) {
    std::reverse(result.begin() + group * kBins / 3, result.begin() + (group + 1) * kBins / 3);
  }
  return result;
}

void offer(std::vector<Match>& best, std::size_t capacity, const Match& match) {
  if (best.size() == capacity && !(match.difference < best.back().difference)) return;
  if (best.size() == capacity) best.pop_back();
  const auto later = [](const Match& a, const Match& b) { return a.difference < b.difference; };
  best.insert(std::upper_bound(best.begin(), best.end(), match, later), match);
}

/// For every keypoint of `from` the most alike points of `to`.
std::vector<Match> match_one_way(const DescribedPoints& from, const DescribedPoints& to, bool same_side,
                                 const RunContext& context) {
  const std::vector<float> blocks = in_blocks(to);
  const std::size_t k = static_cast<std::size_t>(tune::KBEST);
  std::vector<std::vector<Match>> found(from.keypoints.size());
  parallel::for_chunks(
      context, found.size(),
      [&](std::size_t begin, std::size_t end) {
        std::array<float, kLanes> difference;
        for (std::size_t i = begin; i < end; ++i) {
          const Index p = from.keypoints[i];
          Row row;
          std::copy_n(from.descriptor.begin() + p * kBins, kBins, row.begin());
          for (int turn = 0; turn < (same_side ? 1 : 2); ++turn, row = turned(row)) {
            for (std::size_t first = 0; first < to.size(); first += kLanes) {
              compare(row.data(), blocks.data() + first * kBins, difference.data());
              const float limit = found[i].size() < k ? 1e30F : found[i].back().difference;
              for (std::size_t lane = 0; lane < kLanes; ++lane) {
                if (difference[lane] < limit && first + lane < to.size())
                  offer(found[i], k, {p, static_cast<Index>(first + lane), turn == 1, difference[lane]});
              }
            }
          }
        }
      },
      kChunk);
  std::vector<Match> all;
  for (const auto& matches : found) all.insert(all.end(), matches.begin(), matches.end());
  return all;
}

}  // namespace

std::vector<Match> match_descriptors(const DescribedPoints& source, const DescribedPoints& target, bool same_side,
                                     const RunContext& context) {
  std::vector<Match> matches = match_one_way(source, target, same_side, context);
  std::vector<Match> back = match_one_way(target, source, same_side, context);
  for (Match& match : back) {
    std::swap(match.source, match.target);
    matches.push_back(match);
  }
  const auto key = [](const Match& m) { return std::tuple(m.source, m.target, m.turned); };
  std::sort(matches.begin(), matches.end(), [&](const Match& a, const Match& b) { return key(a) < key(b); });
  matches.erase(std::unique(matches.begin(), matches.end(), [&](const Match& a, const Match& b) { return key(a) == key(b); }), matches.end());
  const std::size_t limit = static_cast<std::size_t>(tune::MAXM);
  if (matches.size() > limit) {
    std::sort(matches.begin(), matches.end(), [&](const Match& a, const Match& b) { return std::tuple(a.difference, key(a)) < std::tuple(b.difference, key(b)); });
    matches.resize(limit);
  }
  return matches;
}

}  // namespace shapelight
