#pragma once

#include <filesystem>

#include "shapelight/core/types.hpp"

namespace shapelight {

/// Reads a rigid transform: plain text, 4 rows of 4 numbers, row-major, source into target; lines that start with '#'
/// are comments. Throws ReadError, FormatError (not 16 numbers, last row not 0 0 0 1, or not a rotation to 1e-3);
/// the rotation is made orthonormal.
[[nodiscard]] RigidTransform read_transform(const std::filesystem::path& path);

/// Writes one with 17 digits, beside its target, then renames. Throws WriteError.
void write_transform(const std::filesystem::path& path, const RigidTransform& transform, bool overwrite = false);

}  // namespace shapelight
