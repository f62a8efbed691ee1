#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <span>
#include <utility>
#include <vector>

#include "shapelight/core/types.hpp"

/// numpy arrays in and out. What comes in is read in place: the Python layer has made it C-contiguous and of the right
/// type. What goes out is moved, not copied, and freed with its array.
namespace shapelight::python {

namespace nb = nanobind;

using PointsArray = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;            ///< (n, 3)
using TrianglesArray = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;  ///< (m, 3)
using PoseArray = nb::ndarray<const double, nb::shape<4, 4>, nb::c_contig, nb::device::cpu>;               ///< (4, 4)
template <class T>
using VectorArray = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;  ///< (n,)

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(Index));

[[nodiscard]] inline std::span<const Vec3> as_span(const PointsArray& points) {
  return {reinterpret_cast<const Vec3*>(points.data()), points.shape(0)};
}
[[nodiscard]] inline std::span<const Triangle> as_span(const TrianglesArray& triangles) {
  return {reinterpret_cast<const Triangle*>(triangles.data()), triangles.shape(0)};
}
template <class T>
[[nodiscard]] std::span<const T> as_span(const VectorArray<T>& values) {
  return {values.data(), values.shape(0)};
}

/// A vector becomes an array of the given shape that owns it.
template <class Scalar, class Element>
[[nodiscard]] nb::object own_as_numpy(std::vector<Element>&& values, std::initializer_list<std::size_t> shape) {
  auto* kept = new std::vector<Element>(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Element>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, Scalar>(kept->data(), shape, owner));
}
template <class T>
[[nodiscard]] nb::object to_numpy(std::vector<T>&& values) {
  const std::size_t n = values.size();
  return own_as_numpy<T>(std::move(values), {n});
}
[[nodiscard]] inline nb::object to_numpy(std::vector<Vec3>&& points) {
  const std::size_t n = points.size();
  return own_as_numpy<double>(std::move(points), {n, 3});
}
[[nodiscard]] inline nb::object to_numpy(std::vector<Triangle>&& triangles) {
  const std::size_t n = triangles.size();
  return own_as_numpy<Index>(std::move(triangles), {n, 3});
}
/// A copy.
[[nodiscard]] inline nb::object to_numpy(const Vec3& v) { return to_numpy(std::vector<double>{v.x(), v.y(), v.z()}); }
/// (4, 4), row-major, a copy.
[[nodiscard]] inline nb::object to_numpy(const RigidTransform& transform) {
  std::vector<double> rows;
  rows.reserve(16);
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) rows.push_back(transform.matrix()(r, c));
  }
  return own_as_numpy<double>(std::move(rows), {4, 4});
}

/// An array that looks into memory of `owner`, which it keeps alive.
template <class Scalar>
[[nodiscard]] nb::object view_of(Scalar* data, std::initializer_list<std::size_t> shape, nb::handle owner) {
  return nb::cast(nb::ndarray<nb::numpy, Scalar>(data, shape, owner));
}

/// The transform of a (4, 4) array. Throws InvalidInput unless it is rigid to 1e-6; the rotation is made orthonormal.
[[nodiscard]] RigidTransform to_transform(const PoseArray& pose);

/// A point of three numbers.
[[nodiscard]] Vec3 to_vec3(const std::array<double, 3>& xyz);

}  // namespace shapelight::python
