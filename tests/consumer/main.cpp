#include <cstdio>

#include <shapelight/io/io.hpp>
#include <shapelight/pipeline/sample.hpp>

// Prints how many points of a scan are kept.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const shapelight::Geometry scan = shapelight::read_geometry(argv[1]);
  shapelight::SampleSize size;
  size.count = 500;
  std::printf("%zu\n", shapelight::sample(scan, size).indices.size());
}
