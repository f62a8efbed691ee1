#include "io/output_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "point_files.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight::io {
namespace {

// A stop between two blocks of a long file, and one before the last step.
TEST(OutputFile, LooksForAStopAtEveryBlockAndLeavesNothing) {
  const test::TempFolder folder;
  const auto path = folder.file("a.ply");
  for (const bool at_commit : {false, true}) {
    std::stop_source stop;
    {
      OutputFile file(path, false, {.stop = stop.get_token()});
      file.write("block");
      stop.request_stop();
      if (at_commit) {
        EXPECT_THROW(file.commit(), Cancelled);
      } else {
        EXPECT_THROW(file.write("block"), Cancelled);
      }
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_TRUE(std::filesystem::is_empty(path.parent_path()));
  }
}

}  // namespace
}  // namespace shapelight::io
