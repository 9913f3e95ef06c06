// This density over the hemisphere mixes two powers of the cosine and is drawn without the library's pow:
// exponents are 2^j - 1, whose inverse is j roots.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

// Nothing here is a choice that a processor would guess wrong: parameters come from textures.
class PowerDensity {
 public:
  // Makes a density near cos^exponent, exponent >= 1 (more than 15 counts as 15).
  explicit PowerDensity(float exponent) {
    const float next = std::min(exponent + 1, 16.0f);
    level_ = std::min((std::bit_cast<int>(next) >> 23) - 127, 3);  // of its logarithm
    const auto lower = static_cast<float>(1 << level_);
    upper_ = next / lower - 1;
    weight_[level_ - 1] = (1 - upper_) * lower;
    weight_[level_] = upper_ * (2 * lower);
  }

  // Draws a cosine, > 0, by u in [0, 1).
  double sample(double u) const {
    const double upper{upper_};
    const bool is_upper = u < upper;
    const double inside = is_upper ? u : u - upper, whole = is_upper ? upper : 1 - upper;
    std::array<float, 5> roots;
    roots[0] = static_cast<float>(std::max(1 - inside / whole, 1e-16));
    for (std::size_t k = 0; k < 4; ++k) roots[k + 1] = std::sqrt(roots[k]);
    return double{roots[static_cast<std::size_t>(level_ + (is_upper ? 1 : 0))]};
  }
  // Returns the density, 1/sr, of directions that are uniform in azimuth.
  float pdf(float cosine) const {
    const float c2 = cosine * cosine, c4 = c2 * c2;
    constexpr auto kPerTurn = static_cast<float>(kInvPi / 2);
    const float series = weight_[0] + c2 * (weight_[1] + c4 * (weight_[2] + c4 * c4 * weight_[3]));
    return kPerTurn * cosine * series;
  }

 private:
  int level_;
  float upper_;                    // chance of the next level
  std::array<float, 4> weight_{};  // of cos^(2^j - 1), j from 1 on
};

}  // namespace v1
}  // namespace sunbeam
