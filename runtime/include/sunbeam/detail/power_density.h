// This density over the hemisphere mixes two powers of the cosine and is drawn without the library's pow:
// exponents are 2^j - 1, whose inverse is j roots.
#pragma once

#include <cmath>

#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

class PowerDensity {
 public:
  // Makes a density near cos^exponent, exponent >= 1 (more than 15 counts as 15).
  explicit PowerDensity(float exponent) {
    const float next = exponent + 1;
    level_ = next < 4 ? 1 : next < 8 ? 2 : 3;
    const auto lower = static_cast<float>(1 << level_);
    upper_ = std::min(std::max(next / lower - 1, 0.0f), 1.0f);
  }

  // Draws a cosine, > 0, by u in [0, 1).
  double sample(double u) const {
    const double upper{upper_};
    const bool is_upper = u < upper;
    const int roots = level_ + (is_upper ? 1 : 0);
    double x = is_upper ? 1 - u / upper : 1 - (u - upper) / (1 - upper);
    for (int k = 0; k < roots; ++k) x = std::sqrt(x);
    return x;
  }
  // Returns the density, 1/sr, of directions that are uniform in azimuth.
  float pdf(float cosine) const {
    const float c2 = cosine * cosine, c4 = c2 * c2;
    const float to_level = level_ == 1 ? 1 : level_ == 2 ? c2 : c4 * c2;  // cos^(2^j - 2)
    const float to_next = level_ == 1 ? c2 : level_ == 2 ? c4 : c4 * c4;  // cos^(2^j)
    const auto lower = static_cast<float>(1 << level_);
    constexpr auto kPerTurn = static_cast<float>(kInvPi / 2);
    return kPerTurn * lower * cosine * to_level * (1 - upper_ + upper_ * 2 * to_next);
  }

 private:
  int level_ = 1;
  float upper_ = 0;  // chance of the next level
};

}  // namespace v1
}  // namespace sunbeam
