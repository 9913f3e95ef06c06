// This file says where a number lies between two nodes.
#pragma once

#include <algorithm>
#include <cstddef>

namespace sunbeam {
inline namespace v1 {

// Holds two neighbouring nodes and the weight of the upper one.
struct Bracket {
  std::size_t lower = 0, upper = 0;
  double upper_weight = 0;
};

// Returns where a cosine lies among at least two nodes spread evenly over [0, 1]; it is clamped.
inline Bracket even_bracket(double cosine, std::size_t nodes) {
  const double x = std::clamp(cosine, 0.0, 1.0) * static_cast<double>(nodes - 1);
  const auto lower = std::min(static_cast<std::size_t>(x), nodes - 2);
  return {lower, lower + 1, x - static_cast<double>(lower)};
}

}  // namespace v1
}  // namespace sunbeam
