#include "recorder.hpp"
#include "shapelight/pipeline/sample.hpp"

namespace shapelight::parity {

void record_jobs(const Recorder& recorder) {
  const Geometry dragon = data("scans/dragonStandRight_0.ply");
  recorder.record("sample", sample(dragon, {.count = {}, .ratio = 0.05, .spacing = {}}).indices);
}

}  // namespace shapelight::parity
