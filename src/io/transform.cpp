#include "shapelight/io/transform.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <string>

#include "io/mapped_file.hpp"
#include "io/output_file.hpp"
#include "io/text_scanner.hpp"
#include "shapelight/core/error.hpp"

namespace shapelight {
namespace {

// Files carry few digits; a matrix farther from a rotation than this is something else.
constexpr double kTolerance = 1e-3;

Eigen::Matrix4d read_matrix(io::TextScanner& scanner) {
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16;) {
    if (!scanner.next_data_line('#')) {
      scanner.fail(fmt::format("{} numbers, expected 16: 4 rows of 4", i));
    }
    for (std::string_view token = scanner.next_token(','); !token.empty(); token = scanner.next_token(',')) {
      if (i == 16) scanner.fail("a 17th number, expected 16: 4 rows of 4");
      matrix(i / 4, i % 4) = scanner.need_double(token, "a number");
      if (!std::isfinite(matrix(i / 4, i % 4))) scanner.fail("a number is not finite");
      ++i;
    }
  }
  if (scanner.next_data_line('#')) scanner.fail("more than 16 numbers, expected 4 rows of 4");
  return matrix;
}

}  // namespace

RigidTransform read_transform(const std::filesystem::path& path) {
  const io::MappedFile file(path);
  io::TextScanner scanner(file.text(), "transform", path.string());
  const Eigen::Matrix4d matrix = read_matrix(scanner);
  if (!(matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).isZero(kTolerance)) {
    scanner.fail("the last row is not 0 0 0 1");
  }
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const double off = (linear.transpose() * linear - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > kTolerance) {
    scanner.fail(fmt::format("not a rotation: its rows are {:.2g} off being orthonormal, expected {:g} at most", off,
                             kTolerance));
  }
  if (linear.determinant() < 0.0) scanner.fail("a reflection, expected a rotation");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  RigidTransform transform = RigidTransform::Identity();
  transform.linear() = svd.matrixU() * svd.matrixV().transpose();  // the nearest rotation
  transform.translation() = matrix.topRightCorner<3, 1>();
  return transform;
}

void write_transform(const std::filesystem::path& path, const RigidTransform& transform, bool overwrite) {
  const Eigen::Matrix4d matrix = transform.matrix();
  std::string text;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += fmt::format("{}{:.17g}", column == 0 ? "" : " ", matrix(row, column));
    }
    text += '\n';
  }
  io::OutputFile file(path, overwrite);
  file.write(text);
  file.commit();
}

}  // namespace shapelight
