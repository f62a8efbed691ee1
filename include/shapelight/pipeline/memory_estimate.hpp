#pragma once

#include <cstdint>

namespace shapelight {

/// Peak memory of whole jobs, [bytes] per input point, measured on meshes and clouds of 0.04 to 7 million points and
/// rounded up: for callers that refuse a job before it starts.
inline constexpr std::uint64_t kSampleBytesPerPoint = 900;
inline constexpr std::uint64_t kFieldsBytesPerPoint = 900;
inline constexpr std::uint64_t kSimplifyBytesPerPoint = 1700;
inline constexpr std::uint64_t kRegisterBytesPerPoint = 900;  ///< of all scans together; align too

}  // namespace shapelight
