#include <gtest/gtest.h>

#include <set>

#include "shapelight/pipeline/fields.hpp"
#include "shapelight/pipeline/sample.hpp"
#include "support/data_files.hpp"
#include "support/watch_progress.hpp"

// Progress and cancellation of the whole pipeline.
namespace shapelight {
namespace {

using namespace shapelight::testing;

std::vector<std::pair<std::string, Work>> works(const Geometry& geometry) {
  const auto sampling = [&geometry](const SampleOptions& options) -> Work {
    return [&geometry, options](const RunContext& context) {
      (void)sample(geometry, {.count = {}, .ratio = 0.2, .spacing = {}}, options, context);
    };
  };
  std::vector<std::pair<std::string, Work>> all;
  for (const auto& [preset, name] : enum_names(Preset{})) {
    all.emplace_back(std::string("sample ") + std::string(name), sampling(sample_preset(preset)));
    all.emplace_back(std::string("fields ") + std::string(name), [&geometry, p = preset](const RunContext& context) {
      (void)point_fields(geometry, fields_preset(p), context);
    });
  }
  for (const auto& [method, name] : enum_names(SamplingMethod{})) {
    SampleOptions options;
    options.method = method;
    all.emplace_back(std::string("method ") + std::string(name), sampling(options));
  }
  return all;
}

constexpr const char* kFiles[] = {"meshes/fandisk.off", "scans/bun000_quarter.rif", "clouds/simple.las"};

TEST(PipelineProgress, IsMonotoneAndEndsAtOne) {
  for (const char* file : kFiles) {
    const Geometry geometry = read_data(file);
    for (const auto& [name, work] : works(geometry)) {
      SCOPED_TRACE(std::string(file) + " " + name);
      expect_monotone_to_one(watch(work));
    }
  }
}

TEST(PipelineProgress, NamesThePhases) {
  const Geometry geometry = read_data("meshes/fandisk.off");
  const Seen seen = watch([&](const RunContext& context) {
    (void)sample(geometry, {.count = 100, .ratio = {}, .spacing = {}}, sample_preset(Preset::Paper), context);
  });
  const std::set<std::string> phases(seen.phases.begin(), seen.phases.end());
  for (const char* phase :
       {"build graph", "estimate curvature", "non-local means", "retinex", "segment", "choose points"}) {
    EXPECT_TRUE(phases.contains(phase)) << phase;
  }
}

TEST(PipelineCancel, AStopAtAnyPhaseEndsTheRun) {
  const Geometry mesh = read_data("meshes/fandisk.off");
  const Geometry cloud = read_data("clouds/simple.las");
  for (const Geometry* geometry : {&mesh, &cloud}) {
    for (const auto& [name, work] : works(*geometry)) {
      SCOPED_TRACE(geometry->format + " " + name);
      expect_cancel_everywhere(work);
    }
  }
}

TEST(PipelineCancel, WatchingChangesNothing) {
  const Geometry geometry = read_data("meshes/fandisk.off");
  const SampleSize size{.count = 700, .ratio = {}, .spacing = {}};
  std::vector<Index> watched;
  (void)watch([&](const RunContext& context) { watched = sample(geometry, size, {}, context).indices; });
  EXPECT_EQ(watched, sample(geometry, size).indices);
}

}  // namespace
}  // namespace shapelight
