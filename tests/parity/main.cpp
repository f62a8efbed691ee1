#include <cstdio>

#include "recorder.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: parity FOLDER\n", stderr);
    return 2;
  }
  const shapelight::parity::Recorder recorder{argv[1]};
  shapelight::parity::record_jobs(recorder);
  shapelight::parity::record_graph(recorder);
  shapelight::parity::record_features(recorder);
  shapelight::parity::record_samplers(recorder);
  shapelight::parity::record_spatial(recorder);
  shapelight::parity::record_metrics(recorder);
  shapelight::parity::record_simplify(recorder);
  shapelight::parity::record_registration(recorder);
  shapelight::parity::record_synthetic(recorder);
  shapelight::parity::record_render(recorder);
}
