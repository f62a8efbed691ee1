#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "shapelight/metrics/sampling_quality.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "shapelight/spatial/kd_tree.hpp"
#include "support/data_files.hpp"
#include "support/shapes.hpp"

// Noise must not pass for detail: local picks on a noisy model shall lie on the features of the clean one.
namespace shapelight {
namespace {

using namespace shapelight::testing;

constexpr double kNoise = 0.001;  // of the diagonal
constexpr double kRatio = 0.05;

struct NoisyModel {
  Geometry clean, noisy;
  std::vector<std::uint8_t> feature;  // the most curved tenth of the clean model

  explicit NoisyModel(Geometry geometry) : clean(std::move(geometry)), noisy(clean) {
    const double sigma = kNoise * bounding_box(clean.positions).diagonal();
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      const Vec3 direction(gaussian(3, 0, i), gaussian(3, 1, i), gaussian(3, 2, i));
      noisy.positions[i] += sigma * gaussian(3, 3, i) * direction.normalized();
    }
    const std::vector<double> variation = surface_variation_knn(clean.positions);
    std::vector<double> sorted = variation;
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(9 * sorted.size() / 10);
    std::nth_element(sorted.begin(), last, sorted.end());
    for (const double v : variation) feature.push_back(v >= *last);
  }

  std::vector<Vec3> feature_points() const {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      if (feature[i]) points.push_back(clean.positions[i]);
    }
    return points;
  }
};

struct Share {
  double exact = 0.0;  // of the local picks that are feature points
  double near = 0.0;   // or within one mean spacing of the sample of one
};

// `local(m)`: pick m is a local one.
template <class IsLocal>
Share share_on_features(const NoisyModel& model, const std::vector<Index>& picks, IsLocal&& is_local) {
  std::vector<Vec3> chosen;
  for (const Index i : picks) chosen.push_back(model.clean.positions[i]);
  const double spacing = measure_sampling(model.clean.positions, {}, chosen).spacing_mean;
  const KdTree features(model.feature_points());
  std::size_t num_local = 0, exact = 0, near = 0;
  for (std::size_t m = 0; m < picks.size(); ++m) {
    if (!is_local(m, num_local)) continue;
    ++num_local;
    exact += model.feature[picks[m]];
    near += features.nearest(chosen[m]).distance_sq <= spacing * spacing;
  }
  const auto share = [&](std::size_t count) { return static_cast<double>(count) / static_cast<double>(num_local); };
  return {share(exact), share(near)};
}

Share detail_share(const NoisyModel& model, const Geometry& geometry, const SampleOptions& options) {
  const auto picks = sample(geometry, {.count = {}, .ratio = kRatio, .spacing = {}}, options).indices;
  return share_on_features(model, picks, [&](std::size_t m, std::size_t num_local) {
    return static_cast<double>(num_local) < options.local_weight * static_cast<double>(m + 1);
  });
}

// The paper's local points come first.
Share paper_share(const NoisyModel& model, const Geometry& geometry, bool denoise) {
  SampleOptions options = sample_preset(Preset::Paper);
  options.fields.denoise = denoise;
  const auto picks = sample(geometry, {.count = {}, .ratio = kRatio, .spacing = {}}, options).indices;
  const auto num_local = static_cast<std::size_t>(std::llround(options.local_weight * static_cast<double>(picks.size())));
  return share_on_features(model, picks, [&](std::size_t m, std::size_t) { return m < num_local; });
}

TEST(Noise, DetailPutsLocalPicksOnTrueFeatures) {
  const NoisyModel model(read_data("meshes/armadillo.ply"));
  const Share clean = detail_share(model, model.clean, sample_preset(Preset::Detail));
  const Share noisy = detail_share(model, model.noisy, sample_preset(Preset::Detail));
  const Share fast = detail_share(model, model.noisy, sample_preset(Preset::Fast));
  const Share cloud = detail_share(model, as_cloud(model.noisy), sample_preset(Preset::Detail));
  std::printf("local picks on features (exactly / within a spacing): detail clean %.3f / %.3f, noisy %.3f / %.3f; "
              "fast noisy %.3f / %.3f; noisy cloud %.3f / %.3f\n",
              clean.exact, clean.near, noisy.exact, noisy.near, fast.exact, fast.near, cloud.exact, cloud.near);
  EXPECT_GE(noisy.near, 0.75);
  EXPECT_GE(cloud.near, 0.75);
}

TEST(Noise, NonLocalMeansHelpsThePaper) {
  const NoisyModel model(read_data("meshes/armadillo.ply"));
  const Share with = paper_share(model, model.noisy, true);
  const Share without = paper_share(model, model.noisy, false);
  std::printf("paper, local points on features (exactly / within a spacing): with NLM %.3f / %.3f, without %.3f / %.3f\n",
              with.exact, with.near, without.exact, without.near);
  EXPECT_GT(with.near, 1.2 * without.near);
}

}  // namespace
}  // namespace shapelight
