#pragma once

#include <algorithm>
#include <vector>

namespace shapelight {

/// The middle value, the upper one of two; 0 of nothing. Pre: no NaN. Cost: linear.
template <class T>
[[nodiscard]] T median(std::vector<T> values) {
  if (values.empty()) return T{0};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace shapelight
