#include "shapelight/io/transform.hpp"

#include <gtest/gtest.h>

#include "io/file_support.hpp"

namespace shapelight {
namespace {

using io::test::contains;

RigidTransform sample_transform(double angle = 1.234) {
  RigidTransform transform = RigidTransform::Identity();
  transform.linear() = Eigen::AngleAxisd(angle, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  transform.translation() = Vec3(1.0 / 3.0, -448262.123456789, 1e-9);
  return transform;
}

RigidTransform read_text(std::string_view text) {
  const io::test::TempFolder folder;
  return read_transform(folder.write("t.txt", text));
}

// What the FormatError says.
std::string refused(std::string_view text) {
  try {
    (void)read_text(text);
  } catch (const FormatError& error) {
    return error.what();
  }
  ADD_FAILURE() << "was read: " << text;
  return {};
}

TEST(Transform, WritesWhatItReads) {
  const io::test::TempFolder folder;
  for (const double angle : {0.0, 1e-8, 1.234, 3.14159}) {
    const RigidTransform before = sample_transform(angle);
    write_transform(folder / "t.txt", before, true);
    const RigidTransform after = read_transform(folder / "t.txt");
    EXPECT_EQ(after.translation(), before.translation());
    EXPECT_TRUE(after.linear().isApprox(before.linear(), 1e-15));
    EXPECT_TRUE((after.linear().transpose() * after.linear()).isIdentity(1e-14));
  }
}

TEST(Transform, ReadsCommentsCommasAndAnyLineEnds) {
  const RigidTransform transform =
      read_text("# a comment\r\n0 -1 0 5\r\n\r\n1, 0, 0, 6  # turned\r\n0 0 1 7e0\r\n0 0 0 1");
  EXPECT_EQ(transform * Vec3(1, 2, 3), Vec3(3, 7, 10));
  EXPECT_EQ(read_text("1 0 0 0 0 1 0 0\n0 0 1 0 0 0 0 1\n").matrix(), Eigen::Matrix4d::Identity());
}

TEST(Transform, FewDigitsAreMadeARotation) {
  const RigidTransform transform = read_text("0.8660 -0.5000 0 1\n0.5000 0.8660 0 2\n0 0 1 3\n0 0 0 1\n");
  EXPECT_TRUE((transform.linear().transpose() * transform.linear()).isIdentity(1e-14));
  EXPECT_NEAR(transform.linear()(0, 0), std::sqrt(0.75), 5e-5);
}

TEST(Transform, RefusesWhatIsNone) {
  EXPECT_TRUE(contains(refused(""), "0 numbers, expected 16"));
  EXPECT_TRUE(contains(refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n"), "12 numbers, expected 16"));
  EXPECT_TRUE(contains(refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1 4\n"), "17th number"));
  EXPECT_TRUE(contains(refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n4\n"), "more than 16"));
  EXPECT_TRUE(contains(refused("1 0 0 0\n0 1 zero 0\n0 0 1 0\n0 0 0 1\n"), "line 2"));
  EXPECT_TRUE(contains(refused("1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), "not finite"));
  EXPECT_TRUE(contains(refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n3 0 0 1\n"), "last row"));
  EXPECT_TRUE(contains(refused("2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n"), "not a rotation"));
  EXPECT_TRUE(contains(refused("1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n"), "reflection"));
  EXPECT_THROW((void)read_transform("nowhere/t.txt"), ReadError);
}

TEST(Transform, OverwritesOnlyWhenAllowed) {
  const io::test::TempFolder folder;
  write_transform(folder / "t.txt", sample_transform());
  EXPECT_THROW(write_transform(folder / "t.txt", RigidTransform::Identity()), WriteError);
  EXPECT_EQ(read_transform(folder / "t.txt").translation(), sample_transform().translation());
  write_transform(folder / "t.txt", RigidTransform::Identity(), true);
  EXPECT_EQ(read_transform(folder / "t.txt").matrix(), Eigen::Matrix4d::Identity());
  EXPECT_THROW(write_transform(folder / "no" / "t.txt", sample_transform()), WriteError);
}

}  // namespace
}  // namespace shapelight
